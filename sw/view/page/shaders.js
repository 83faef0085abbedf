// SPDX-License-Identifier: Apache-2.0
// What runs on the graphics: balls that are squares with the look and the depth of a ball, and lines.
const place = `#version 300 es
precision highp float;
in float px, py, pz, tint, hide, size;
uniform vec3 A, B, C;
uniform mat4 view, project;
vec4 seen() { return view * vec4((vec3(px, py, pz) - C) * A + B, 1.0); }
`;

fp3.ballVertex = place + `
in vec2 corner;
uniform vec2 pixels;
uniform float radius, least;
uniform int picked;
flat out vec3 centre;
flat out float ballRadius, ballTint;
flat out int isPicked;
out vec2 at;
void main() {
  vec4 v = seen();
  float pixel = (project * v).w * 2.0 / (project[1][1] * pixels.y);
  isPicked = gl_InstanceID == picked ? 1 : 0;
  ballRadius = max(radius * size, (least + 2.5 * float(isPicked)) * pixel);
  ballTint = tint;
  centre = v.xyz;
  at = corner;
  gl_Position = hide > 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : project * (v + vec4(corner * ballRadius, 0.0, 0.0));
}`;

const colour = `#version 300 es
precision highp float;
uniform vec3 stops[6];
uniform vec3 plain, mark;
vec3 tinted(float t) {
  if (t < -1.5) return vec3(0.5);
  if (t < 0.0) return plain;
  float s = clamp(t, 0.0, 1.0) * 5.0;
  int i = min(int(s), 4);
  return mix(stops[i], stops[i + 1], s - float(i));
}
out vec4 pixel;
`;

fp3.ballFragment = colour + `
uniform mat4 project;
flat in vec3 centre;
flat in float ballRadius, ballTint;
flat in int isPicked;
in vec2 at;
void main() {
  float d = dot(at, at);
  if (d > 1.0) discard;
  vec3 normal = vec3(at, sqrt(1.0 - d));
  float light = 0.5 + 0.5 * max(dot(normal, normalize(vec3(-0.35, 0.6, 0.72))), 0.0);
  vec4 clip = project * vec4(centre + normal * ballRadius, 1.0);
  gl_FragDepth = clamp(clip.z / clip.w * 0.5 + 0.5, 0.0, 1.0);
  pixel = vec4(isPicked == 1 && d > 0.5 ? mark : tinted(ballTint) * light, 1.0);
}`;

fp3.lineVertex = place + `
out float lineTint, lineHide;
void main() {
  lineTint = tint;
  lineHide = hide;
  gl_Position = project * seen();
}`;

fp3.lineFragment = colour + `
uniform vec4 ink;
uniform float mixed;
in float lineTint, lineHide;
void main() {
  if (lineHide > 0.0) discard;
  pixel = vec4(mix(ink.rgb, tinted(lineTint), lineTint < 0.0 ? 0.0 : mixed), ink.a);
}`;

// ---- bodies ----

// Of each body the texture has the place, a quaternion, and the colour with its paleness.
const body = `#version 300 es
precision highp float;
uniform highp sampler2D poses;
uniform mat4 view, project;
uniform float scale;
out vec3 lit;
out float sector;
flat out vec4 ink;
flat out int number;
vec4 part(int k) {
  int i = 3 * number + k, wide = textureSize(poses, 0).x;
  return texelFetch(poses, ivec2(i % wide, i / wide), 0);
}
vec3 turned(vec4 q, vec3 p) { return p + 2.0 * cross(q.yzw, cross(q.yzw, p) + q.x * p); }
void put(vec3 at, vec3 normal, float object) {
  number = int(object);
  vec4 place = part(0), q = part(1);
  ink = part(2);
  lit = mat3(view) * turned(q, normal);
  gl_Position = place.w > 0.5 ? project * (view * vec4(place.xyz + scale * turned(q, at), 1.0)) : vec4(2.0, 2.0, 2.0, 1.0);
}
`;

fp3.faceVertex = body + `
layout(location = 0) in vec3 at;
layout(location = 1) in vec3 normal;
layout(location = 2) in float object;
void main() {
  sector = 0.0;
  put(at, normal, object);
}`;

// From end to end of a way, with a radius; sectors show how it is turned.
fp3.roundVertex = body + `
layout(location = 0) in vec4 from;
layout(location = 1) in vec3 a;
layout(location = 2) in vec3 b;
layout(location = 3) in vec3 more;
void main() {
  vec3 up = a == b ? vec3(0.0, 0.0, 1.0) : normalize(b - a), s = abs(up);
  vec3 axis = s.x <= s.y && s.x <= s.z ? vec3(1.0, 0.0, 0.0) : s.y <= s.z ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
  vec3 right = normalize(cross(axis, up)), normal = mat3(right, cross(up, right), up) * from.xyz;
  sector = more.z * from.x * from.y;
  put((from.w > 0.5 ? b : a) + more.x * normal, normal, more.y);
}`;

fp3.bodyFragment = `#version 300 es
precision highp float;
uniform vec3 back;
uniform vec4 rim;
uniform float pale, cover;
uniform int isPicking;
in vec3 lit;
in float sector;
flat in vec4 ink;
flat in int number;
out vec4 pixel;
void main() {
  float light = length(lit) < 0.5 ? 1.0 : 0.5 + 0.5 * max(dot(normalize(lit), vec3(-5.0, 8.0, 10.0) / 14.0), 0.0);
  if (sector > 0.0) light *= 0.8125;
  pixel = vec4(mix(mix(ink.rgb, back, pale < 0.0 ? ink.a : pale) * light, rim.rgb, rim.a), cover);
  if (isPicking == 1) pixel = vec4(float(number & 255), float(number >> 8 & 255), float(number >> 16), 255.0) / 255.0;
}`;

// From dark to bright, so that it can be told in grey, too.
fp3.stops = [[52, 41, 122], [38, 98, 168], [22, 146, 156], [74, 184, 112], [170, 205, 66], [250, 218, 72]];
