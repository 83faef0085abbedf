// SPDX-License-Identifier: Apache-2.0
// Where the shapes of rigid bodies are: sw/view/outline.h does the same for pictures.
const {about, world} = fp3;
const bodies = about.bodies; // null: there are none
const count = about.objects;
fp3.bodies = bodies;

// ---- edges, in the axes of the body ----

// Of each direction the corner that is farthest, and the radius beyond it; equal points stand once.
const outlineOf = shape => {
  const points = [];
  for (let i = 0; i < bodies.ways; i++) {
    const angle = 2 * Math.PI * i / bodies.ways, x = Math.cos(angle), y = Math.sin(angle);
    const [cx, cy] = shape.corners.reduce((best, c) => c[0] * x + c[1] * y > best[0] * x + best[1] * y ? c : best);
    const point = [cx + shape.radius * x, cy + shape.radius * y], last = points.at(-1);
    if (!last || last[0] !== point[0] || last[1] !== point[1]) points.push(point);
  }
  return points.length > 1 && points[0].every((x, k) => x === points.at(-1)[k]) ? points.slice(0, -1) : points;
};

// ---- where they are ----

// Of all objects: the place, the cosine and the sine; NaN: nowhere.
let poses = null, posed = -1;
const pose = snapshot => {
  if (posed === snapshot) return poses;
  poses = poses || new Float64Array(4 * count);
  for (let i = 0; i < count; i++) {
    const at = snapshot * count + i, angle = fp3.value(about.columns[bodies.turn], at);
    poses[4 * i] = fp3.value(fp3.axes[0], at);
    poses[4 * i + 1] = fp3.value(fp3.axes[1], at);
    poses[4 * i + 2] = Math.cos(angle);
    poses[4 * i + 3] = Math.sin(angle);
  }
  posed = snapshot;
  return poses;
};

// A point of a body in the world of the page.
const placed = (p, object, [x, y]) => {
  const o = 4 * object;
  return [world.of(0, p[o] + p[o + 2] * x - p[o + 3] * y), world.of(1, p[o + 1] + p[o + 3] * x + p[o + 2] * y)];
};

if (bodies) {
  for (const shape of bodies.shapes) shape.outline = outlineOf(shape);
  bodies.shapes.sort((a, b) => b.isSensor - a.isSensor); // behind all others
  bodies.byObject = Array.from({length: count}, () => []);
  for (const shape of bodies.shapes) bodies.byObject[shape.object].push(shape);

  bodies.kindOf = (shape, snapshot) => {
    if (shape.isSensor) return "sensor";
    if (shape.type === 2) return "static";
    return bodies.asleep >= 0 && fp3.value(about.columns[bodies.asleep], snapshot * count + shape.object) < 0 ? "asleep" : "awake";
  };

  bodies.points = (shape, snapshot) => {
    const p = pose(snapshot);
    return shape.outline.map(point => placed(p, shape.object, point));
  };

  // The middle of a circle, from which a line to the first point of its edge shows how it is turned.
  bodies.middle = (shape, snapshot) => placed(pose(snapshot), shape.object, shape.corners[0]);

  bodies.ends = (joint, snapshot) => joint.anchors.map((anchor, i) => placed(pose(snapshot), joint.of[i], anchor));

  // Whether a point is within the shape of an object, all as seen: [x, y] pairs.
  bodies.covers = (edge, x, y) => {
    let isWithin = false;
    for (let i = 0, k = edge.length - 1; i < edge.length; k = i++)
      if (edge[i][1] > y !== edge[k][1] > y && x < (edge[k][0] - edge[i][0]) * (y - edge[i][1]) / (edge[k][1] - edge[i][1]) + edge[i][0])
        isWithin = !isWithin;
    return isWithin;
  };
}
