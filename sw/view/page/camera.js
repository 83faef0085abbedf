// SPDX-License-Identifier: Apache-2.0
// Where the eye is: it looks at a target from a distance, turned around an axis that points up.
const about = fp3.about;
const axes = about.position.columns.map(k => about.columns[k]);
const isFlat = axes.length < 3;

// ---- data to world: the largest side is 2 long, the middle is 0 ----

const reach = about.radiusOf >= 0 ? Math.max(0, about.columns[about.radiusOf].most) : about.radius;
const ends = [0, 1, 2].map(k => {
  if (k >= axes.length) return [0, 0];
  if (about.isSeen) return about.ends[k];
  const list = about.ends ? [...about.ends[k]] : [axes[k].least - reach, axes[k].most + reach];
  if (about.box.length) list.push(about.box[k], about.box[3 + k]);
  for (const plane of about.planes) if (plane.axis === k) list.push(plane.at);
  return [Math.min(...list), Math.max(...list)];
});
const widths = ends.map(([least, most]) => most - least);
const widest = Math.max(...widths);
const shape = [3.2, 2, 2]; // of axes in different units
const world = {
  ends,
  middle: ends.map(([least, most]) => (least + most) / 2),
  scale: widths.map((width, k) => about.position.hasOneScale ? (widest > 0 ? 2 / widest : 1) : width > 0 ? shape[k] / width : 1),
};
world.of = (k, value) => (value - world.middle[k]) * world.scale[k];
world.half = widths.map((width, k) => Math.max(width * world.scale[k] / 2, 0));
fp3.world = world;
fp3.axes = axes;
fp3.isFlat = isFlat;

// ---- vectors ----

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = a => a.map(x => x / Math.hypot(...a));

// ---- the camera ----

const FIELD = 35 * Math.PI / 180; // of view
const camera = {up: about.up};
fp3.camera = camera;

camera.reset = () => {
  camera.azimuth = isFlat ? 0 : 0.55;
  camera.elevation = isFlat ? 0 : 0.35;
  camera.target = [0, 0, 0];
  camera.near = 1; // how near the eye is: above 1 nearer
};

// Right, up and back, seen from the target.
const turned = () => {
  const {azimuth, elevation} = camera;
  const right = [Math.cos(azimuth), 0, -Math.sin(azimuth)];
  const back = [Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation), Math.cos(azimuth) * Math.cos(elevation)];
  const turn = a => camera.up === 2 && !isFlat ? [a[0], -a[2], a[1]] : a;
  return {right: turn(right), back: turn(back), up: turn(cross(back, right))};
};

// The half height of what is seen at the target, such that all fits into a picture of this shape.
const halfHeight = aspect => {
  const {half} = world;
  const radius = isFlat ? Math.max(half[1], half[0] / aspect, 1e-6) * 1.28 : Math.max(Math.hypot(...half), 1e-6) / Math.min(1, aspect) * 1.04;
  return radius / camera.near;
};

// Column by column, as WebGL has them.
camera.matrices = aspect => {
  const {right, up, back} = turned(), high = halfHeight(aspect), t = camera.target;
  const distance = high / Math.tan(FIELD / 2), eye = t.map((x, k) => x + back[k] * distance);
  const far = distance + 12, near = Math.max(distance - 12, distance / 50);
  const f = 1 / Math.tan(FIELD / 2);
  camera.view = new Float32Array([right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
  camera.project = new Float32Array(isFlat
    ? [1 / (high * aspect), 0, 0, 0, 0, 1 / high, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near), 1]
    : [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0]);
  camera.high = high;
};

// Where a point of the world is in a picture: x and y from 0 to 1, how far away, and how large a length 1 is (of the height).
camera.see = (x, y, z) => {
  const v = camera.view, p = camera.project;
  const ex = v[0] * x + v[4] * y + v[8] * z + v[12], ey = v[1] * x + v[5] * y + v[9] * z + v[13], ez = v[2] * x + v[6] * y + v[10] * z + v[14];
  const w = isFlat ? 1 : -ez;
  return {x: 0.5 + p[0] * ex / w / 2, y: 0.5 - p[5] * ey / w / 2, away: -ez, size: p[5] / w / 2};
};

camera.orbit = (right, up) => {
  if (isFlat) return camera.pan(right / Math.PI, up / Math.PI);
  camera.azimuth -= right;
  camera.elevation = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, camera.elevation + up));
};

// By parts of the picture's height.
camera.pan = (right, up) => {
  const axis = turned();
  camera.target = camera.target.map((x, k) => x - 2 * camera.high * (right * axis.right[k] - up * axis.up[k]));
};

camera.zoom = factor => {
  camera.near = Math.min(500, Math.max(0.1, camera.near * factor));
};

camera.reset();
