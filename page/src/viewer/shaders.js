// How the merged mesh (data/merge.js) is drawn. A texture holds three texels a piece, which the vertices look up:
// position and visibility, rotation, colour and whether it is selected.

/** Texels of a piece in that texture, and pieces in a row of it. */
export const TEXELS = 3;
export const PIECES_PER_ROW = 341;
/** Base colours and roughness of materials that the shader holds; further materials look like the last. */
export const MATERIALS = 64;

const PLACE = /* glsl */ `
  uniform highp sampler2D pieces;
  in uint key;

  ivec2 texel(uint piece, int which) {
    return ivec2(int(piece % ${PIECES_PER_ROW}u) * ${TEXELS} + which, int(piece / ${PIECES_PER_ROW}u));
  }
  vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
  // Pieces that do not exist at this moment become a point.
  vec3 placed(uint piece, vec3 local, out vec4 rotation) {
    vec4 place = texelFetch(pieces, texel(piece, 0), 0);
    rotation = texelFetch(pieces, texel(piece, 1), 0);
    return place.xyz + place.w * turned(rotation, local);
  }
`;

export const surfaceVertex = /* glsl */ `
  ${PLACE}
  uniform int mode;
  uniform vec4 materials[${MATERIALS}];
  uniform vec2 damageRange;
  in vec4 shade;
  in float damage;
  out vec3 viewPosition;
  out vec4 smoothNormal;
  out float ramp;
  flat out vec4 base;
  flat out vec2 state;

  void main() {
    uint piece = key >> 12u;
    bool inside = (key & 1u) == 1u;
    vec4 rotation;
    vec4 view = viewMatrix * vec4(placed(piece, position, rotation), 1.0);
    viewPosition = view.xyz;
    smoothNormal = vec4(mat3(viewMatrix) * turned(rotation, shade.xyz), shade.w);
    vec4 look = texelFetch(pieces, texel(piece, 2), 0);
    base = materials[min(int((key >> 1u) & 2047u), ${MATERIALS - 1})];
    ramp = -1.0;
    if (mode == 1) base.rgb = look.rgb * (inside ? 0.6 : 1.0);
    if (mode == 2) {
      base.rgb = inside ? vec3(0.30) : vec3(0.45);
      if (damage >= 0.0) ramp = clamp((damage - damageRange.x) / (damageRange.y - damageRange.x), 0.0, 1.0);
    }
    state = vec2(look.w, inside ? 1.0 : 0.0);
    gl_Position = projectionMatrix * view;
  }
`;

export const surfaceFragment = /* glsl */ `
  uniform sampler2D ramps;
  uniform vec3 accent;
  uniform vec3 up;
  uniform float exposure;
  in vec3 viewPosition;
  in vec4 smoothNormal;
  in float ramp;
  flat in vec4 base;
  flat in vec2 state;

  void main() {
    vec3 flatNormal = normalize(cross(dFdx(viewPosition), dFdy(viewPosition)));
    float weight = dot(smoothNormal.xyz, flatNormal) > 0.0 ? smoothNormal.w : 0.0;
    vec3 normal = normalize(mix(flatNormal, smoothNormal.xyz, weight));
    vec3 toEye = normalize(-viewPosition);
    vec3 colour = ramp < 0.0 ? base.rgb : texture(ramps, vec2(ramp, 0.5)).rgb;
    if (state.x > 0.5) colour = mix(colour, accent, 0.65);

    const vec3 key = normalize(vec3(-0.45, 0.75, 0.6));
    float sky = 0.5 + 0.5 * dot(normal, up);
    vec3 light = mix(vec3(0.24, 0.22, 0.21), vec3(0.50, 0.53, 0.58), sky);
    light += vec3(0.78, 0.76, 0.72) * max(dot(normal, key), 0.0);
    light += vec3(0.10, 0.12, 0.15) * max(dot(normal, vec3(0.8, -0.1, 0.3)), 0.0);
    float gloss = 1.0 - base.w;
    float shine = pow(max(dot(normal, normalize(key + toEye)), 0.0), mix(8.0, 90.0, gloss)) * gloss * gloss * 0.5;
    float rim = pow(1.0 - max(dot(normal, toEye), 0.0), 3.0);
    vec3 lit = colour * light * exposure + shine + rim * (state.x > 0.5 ? accent : vec3(0.05));
    gl_FragColor = vec4(lit, 1.0);
    #include <colorspace_fragment>
  }
`;

/** Draws the number of each piece, plus one, as a colour. */
export const pickVertex = /* glsl */ `
  ${PLACE}
  flat out uint number;
  void main() {
    vec4 rotation;
    number = (key >> 12u) + 1u;
    gl_Position = projectionMatrix * viewMatrix * vec4(placed(key >> 12u, position, rotation), 1.0);
  }
`;

export const pickFragment = /* glsl */ `
  flat in uint number;
  void main() {
    gl_FragColor = vec4(float(number & 255u), float((number >> 8u) & 255u), float(number >> 16u), 255.0) / 255.0;
  }
`;

/** The mesh laid flat on the floor along the light: its shadow. */
export const shadowVertex = /* glsl */ `
  ${PLACE}
  uniform float ground;
  out float fade;
  void main() {
    vec4 rotation;
    vec3 world = placed(key >> 12u, position, rotation);
    float height = max(world.y - ground, 0.0);
    world.xz += vec2(0.30, -0.22) * height;
    world.y = ground;
    fade = height;
    gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
  }
`;

export const shadowFragment = /* glsl */ `
  uniform float reach;
  uniform float strength;
  in float fade;
  void main() { gl_FragColor = vec4(0.0, 0.0, 0.0, strength * exp(-fade / reach)); }
`;

export const floorVertex = /* glsl */ `
  uniform float radius;
  out vec2 place;
  void main() {
    place = radius * position.xz;
    gl_Position = projectionMatrix * viewMatrix * modelMatrix * vec4(position, 1.0);
  }
`;

/** A level floor with lines a `spacing` apart and as many pixels thick, stronger at each tenth; it fades out. */
export const floorFragment = /* glsl */ `
  uniform vec3 colour;
  uniform float spacing;
  uniform float radius;
  uniform float thickness;
  in vec2 place;
  float lines(float every) {
    vec2 x = place / every;
    vec2 width = fwidth(x);
    vec2 line = 1.0 - smoothstep(vec2(0.0), thickness * width, abs(fract(x - 0.5) - 0.5));
    return max(line.x, line.y) * (1.0 - smoothstep(0.15, 0.6, max(width.x, width.y)));
  }
  void main() {
    float distance = length(place) / radius;
    float fade = 1.0 - smoothstep(0.25, 1.0, distance);
    float line = max(0.55 * lines(spacing), lines(10.0 * spacing));
    gl_FragColor = vec4(colour, fade * (0.05 + 0.34 * line));
    #include <colorspace_fragment>
  }
`;
