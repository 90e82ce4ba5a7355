# SPDX-License-Identifier: GPL-3.0-or-later
"""The renderer's lobes, from tables or in closed form, against Walter et al.'s BSDF (2007), integrated over
directions in numpy."""

import numpy as np
import pytest
import verglas_core as verglas


def distribution(ndf, alpha, cosine):
    cos2 = cosine ** 2
    tan2 = (1 - cos2) / cos2
    if ndf == "BLINN_PHONG":
        exponent = 2 / alpha ** 2 - 2
        return (exponent + 2) / (2 * np.pi) * cosine ** exponent
    if ndf == "GGX":
        return alpha ** 2 / (np.pi * cos2 ** 2 * (alpha ** 2 + tan2) ** 2)
    return np.exp(-tan2 / alpha ** 2) / (np.pi * alpha ** 2 * cos2 ** 2)


def masking(ndf, alpha, cosine):
    tangent = np.sqrt(1 - cosine ** 2) / cosine
    if ndf == "GGX":
        return 2 / (1 + np.sqrt(1 + (alpha * tangent) ** 2))
    a = 1 / np.maximum(alpha * tangent, 1e-9)
    return np.where(a < 1.6, (3.535 * a + 2.181 * a ** 2) / (1 + 2.276 * a + 2.577 * a ** 2), 1.0)


def fresnel(cos_i, eta):
    sin_t = np.sqrt(1 - cos_i ** 2) / eta
    cos_t = np.sqrt(np.maximum(1 - sin_t ** 2, 0))
    s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    return np.where(sin_t >= 1, 1.0, 0.5 * (s ** 2 + p ** 2))


def integrate(ndf, alpha, eta, cos_theta_o, event):
    """Energy, mean resultant length and mean direction of BSDF times cosine over all directions i."""
    o = np.array([np.sqrt(1 - cos_theta_o ** 2), 0, cos_theta_o])
    reflect = event == "REFLECT"
    middles = (np.arange(800) + 0.5) / 800
    theta, azimuth = np.meshgrid(middles * np.pi / 2, middles * 2 * np.pi)
    solid_angle = np.sin(theta) * (np.pi / 2) * (2 * np.pi) / theta.size
    z = np.cos(theta) * (1 if reflect else -1)
    i = np.stack([np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), z], -1)
    h = o + i if reflect else o + eta * i
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    h *= np.sign(h[..., 2:])
    o_h, i_h = h @ o, (h * i).sum(-1)
    valid = (o_h > 0) & ((i_h > 0) if reflect else (i_h < 0))
    jacobian = 1 / (4 * i_h) if reflect else eta ** 2 * np.abs(i_h) / (o_h + eta * i_h) ** 2
    F = fresnel(np.clip(o_h, 1e-6, 1), eta)
    share = {"REFRACT": 1 - F, "REFRACT_WITHOUT_FRESNEL": F < 1, "REFLECT": F}[event]
    density = o_h / o[2] * share * masking(ndf, alpha, o[2]) * masking(ndf, alpha, np.abs(z)) \
        * distribution(ndf, alpha, h[..., 2]) * jacobian
    density = np.where(valid, density, 0) * solid_angle
    vector = (density[..., None] * i).sum((0, 1))
    energy = density.sum()
    length = np.linalg.norm(vector)
    return energy, length / energy, vector / length


def errors(ndf, roughness, eta, cos_theta_o, event, lobes):
    """Of energy; of the direction, in degrees; of 1 - R, relative."""
    energy, R, direction = integrate(ndf, roughness ** 2, eta, cos_theta_o, event)
    W, kappa, p = verglas.interface_lobe(ndf, roughness, eta, cos_theta_o, event, lobes)
    spread = 1 - (1 / np.tanh(kappa) - 1 / kappa)
    return abs(W - energy), np.degrees(np.arccos(min(np.dot(p, direction), 1))), abs(spread / (1 - R) - 1)


@pytest.mark.parametrize("event", ["REFRACT", "REFRACT_WITHOUT_FRESNEL", "REFLECT"])
@pytest.mark.parametrize("eta", [1.5, 1 / 1.5])
@pytest.mark.parametrize("ndf", ["BECKMANN", "GGX", "BLINN_PHONG"])
def test_lobe_is_the_integral(ndf, eta, event):
    """A researcher loses: the renderer's lobes, to plot beside the exact ones."""
    for roughness, cos_theta_o in (0.4, 1.0), (0.4, 0.5), (0.7, 0.8), (0.7, 0.3):
        energy, degrees, spread = errors(ndf, roughness, eta, cos_theta_o, event, "TABLE")
        assert energy < 0.01 and degrees < 1.0 and spread < 0.05


@pytest.mark.parametrize("event", ["REFRACT", "REFRACT_WITHOUT_FRESNEL", "REFLECT"])
def test_analytic_lobe_is_near_the_integral(event):
    """A researcher loses: lobes in closed form, to plot beside the exact ones."""
    for roughness, cos_theta_o in (0.25, 1.0), (0.25, 0.5), (0.4, 0.8), (0.5, 0.5):
        energy, degrees, spread = errors("BECKMANN", roughness, 1.5, cos_theta_o, event, "ANALYTIC")
        assert energy < 0.01 and degrees < 1.0 and spread < 0.12


def test_values_out_of_range_are_named():
    """A scripter loses: a sentence that says which value is wrong."""
    right = {"ndf": "GGX", "roughness": 0.5, "eta": 1.5, "cos_theta_o": 0.5, "event": "REFRACT",
             "lobes": "TABLE"}
    wrong = {"ndf": "PHONG", "roughness": 1.5, "eta": 0.0, "cos_theta_o": np.nan, "event": "ABSORB",
             "lobes": "FITTED"}
    words = ("PHONG", "roughness", "index", "cosine", "ABSORB", "FITTED")
    for (name, value), word in zip(wrong.items(), words):
        with pytest.raises(verglas.Error, match=word):
            verglas.interface_lobe(**{**right, name: value})


@pytest.mark.parametrize("function", [verglas.warped_beam, verglas.kappa_by_jacobians])
def test_beams_out_of_range_are_named(function):
    """The same of beams; those that are totally reflected would come back as not a number."""
    right = {"kappa_o": 100.0, "kappa_m": 50.0, "cos_theta_o": 0.5, "eta": 1.5}
    function(**right)
    function(100.0, 50.0, 0.5)
    for name, value, word in (("kappa_o", 0.0, "concentration"), ("kappa_m", np.nan, "concentration"),
                              ("cos_theta_o", 1.5, "cosine"), ("eta", 0.0, "index"),
                              ("eta", 1 / 1.5, "totally reflected")):
        with pytest.raises(verglas.Error, match=word):
            function(**{**right, name: value})
    with pytest.raises(verglas.Error, match="concentration"):
        verglas.vmf_facing_area(0.0, 0.5)
    with pytest.raises(verglas.Error, match="cosine"):
        verglas.vmf_facing_area(1.0, -0.5)
