// SPDX-License-Identifier: GPL-3.0-or-later
// A texel of a geometry buffer: the normal in octahedral coordinates, the distance along the camera's axis, and
// an index (nearest front: of the group and material, others: of the material; of the nearest backs in a group of their
// own), -1 where nothing is.

vec2 encode_normal(vec3 n) {
    n /= abs(n.x) + abs(n.y) + abs(n.z);
    vec2 folded = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
    return n.z >= 0.0 ? n.xy : folded;
}

vec3 decode_normal(vec2 e) {
    vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    float t = max(-n.z, 0.0);
    n.x += n.x >= 0.0 ? -t : t;
    n.y += n.y >= 0.0 ? -t : t;
    return normalize(n);
}

// Two indices in one float, exact up to 2^24.
const float GROUP_SIZE = 4096.0;

float encode_index(int group, int material) { return float(group) * GROUP_SIZE + float(material); }
int decode_group(float index) { return int(floor(index / GROUP_SIZE)); }
int decode_material(float index) { return int(mod(index, GROUP_SIZE)); }

// The group of nearest back faces.
const int NEAREST_BACKS = 4095;
