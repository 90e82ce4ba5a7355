// SPDX-License-Identifier: GPL-3.0-or-later
// OpenGL 4.5 core. The entry points come from GLVND's libOpenGL, which dispatches by the calling thread's
// current context and so lives beside Blender's own GLX or Wayland contexts.
#pragma once

#include <GL/glcorearb.h>
