# SPDX-License-Identifier: GPL-3.0-or-later
"""What Verglas costs, on the machine it runs on: ./verglas bench.

A module measures one kind of cost and returns rows, flat records that go into bench.json as they are. Times
are milliseconds. Those of different machines don't compare; ratios within one run do."""
