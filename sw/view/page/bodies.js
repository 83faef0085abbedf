// SPDX-License-Identifier: Apache-2.0
// Rigid bodies: the graphics hold their shapes, and place and turn them in each snapshot. sw/view/bodies.c does the same for pictures.
const {about, world, camera} = fp3;
const bodies = about.bodies; // null: there are none
fp3.bodies = bodies;

const count = about.objects;
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const minus = (a, b) => a.map((x, k) => x - b[k]);
const along = (a, s, b) => a.map((x, k) => x + s * b[k]);
const unit = a => a.map(x => x / Math.hypot(...a));
const turned = ([w, ...v], p) => along(p, 2, cross(v, along(cross(v, p), w, p)));

// ---- where they are ----

// Of all objects: the place and a quaternion of length 1; NaN: nowhere.
let poses = [], posed = -1;
const posesAt = snapshot => {
  if (posed === snapshot) return poses;
  const turns = bodies.turn.map(k => about.columns[k]);
  poses = Array.from({length: count}, (_, i) => {
    const at = snapshot * count + i, turn = turns.map(column => fp3.value(column, at));
    const q = turn.length > 1 ? unit(turn) : [Math.cos(turn[0] / 2), 0, 0, Math.sin(turn[0] / 2)];
    return {x: [0, 1, 2].map(k => fp3.axes[k] ? fp3.value(fp3.axes[k], at) : 0), q};
  });
  posed = snapshot;
  return poses;
};

const toWorld = x => x.map((value, k) => k < fp3.axes.length ? world.of(k, value) : 0);
const placed = ({x, q}, point) => toWorld(along(x, 1, turned(q, point)));

// ---- shapes, in the axes of the body ----

// In a plane: of each direction the corner that is farthest, and the radius beyond it; equal points stand once.
const outlineOf = shape => {
  const points = [];
  for (let i = 0; i < bodies.ways; i++) {
    const angle = 2 * Math.PI * i / bodies.ways, way = [Math.cos(angle), Math.sin(angle), 0];
    const far = c => c[0] * way[0] + c[1] * way[1];
    const point = along(shape.corners.reduce((best, c) => far(c) > far(best) ? c : best), shape.radius, way), last = points.at(-1);
    if (!last || last.some((x, k) => x !== point[k])) points.push(point);
  }
  return points.length > 1 && points[0].every((x, k) => x === points.at(-1)[k]) ? points.slice(0, -1) : points;
};

const NONE = [0, 0, 0];
const addVertex = (list, point, normal, object) => list.push(...point, ...normal, object);

const addFlat = (to, {object, ...shape}) => {
  const points = outlineOf(shape);
  points.forEach((point, i) => {
    const next = points[(i + 1) % points.length];
    if (i > 0 && i + 1 < points.length) for (const p of [points[0], point, next]) addVertex(to.faces, p, NONE, object);
    for (const p of [point, next]) addVertex(to.lines, p, NONE, object);
  });
  if (shape.corners.length === 1) for (const p of [shape.corners[0], points[0]]) addVertex(to.lines, p, NONE, object); // how a circle is turned
};

// Faces are moved out by the radius; edges are round, or lines if there is no radius.
const addSolid = (to, {object, corners, radius, triangles, edges}) => {
  for (const triangle of triangles) {
    const points = triangle.map(k => corners[k]), normal = unit(cross(minus(points[1], points[0]), minus(points[2], points[0])));
    for (const point of points) addVertex(to.faces, along(point, radius, normal), normal, object);
  }
  for (const [a, b] of edges)
    if (radius > 0) to.rounds.push(...corners[a], ...corners[b], radius, object, triangles.length ? 0 : 1);
    else for (const k of [a, b]) addVertex(to.lines, corners[k], NONE, object);
};

// A ball that is pulled apart at its equator: a direction, and 0 or 1 for its end.
const roundOf = ways => {
  const points = [], corners = [], rings = ways / 4;
  for (let end = 0; end < 2; end++)
    for (let ring = 0; ring <= rings; ring++)
      for (let k = 0; k <= ways; k++) {
        const high = (ring / rings - 1 + end) * Math.PI / 2, angle = 2 * Math.PI * k / ways;
        points.push(Math.cos(high) * Math.cos(angle), Math.cos(high) * Math.sin(angle), Math.sin(high), end);
      }
  for (let i = 0; i < (2 * rings + 1) * (ways + 1) - 1; i++)
    if (i % (ways + 1) < ways) corners.push(i, i + 1, i + ways + 2, i, i + ways + 2, i + ways + 1);
  return {points: new Float32Array(points), corners: new Uint16Array(corners)};
};

// The disc of a plane that is within the ball around all that is seen, as vertices of an object that stands at the origin.
const addPlane = (list, {object, corners}, number) => {
  const [from, to] = corners.map(corner => placed(poses[object], corner)), normal = unit(minus(to, from));
  const high = from.reduce((sum, x, k) => sum + x * normal[k], 0), left = Math.hypot(...world.half) ** 2 - high ** 2;
  const right = unit(cross(normal, Math.abs(normal[0]) < 0.5 ? [1, 0, 0] : [0, 1, 0])), up = cross(normal, right);
  const middle = normal.map(x => x * high);
  const at = k => along(along(middle, Math.sqrt(left) * Math.cos(k), right), Math.sqrt(left) * Math.sin(k), up);
  for (let k = 0; left > 0 && k < bodies.ways; k++)
    for (const point of [middle, at(2 * Math.PI * k / bodies.ways), at(2 * Math.PI * (k + 1) / bodies.ways)])
      addVertex(list, point.map(x => x / world.scale[0]), normal, count + number);
};

// ---- what the graphics hold ----

const WIDE = 1024; // of the texture: the place, the quaternion and the colour of each object, one after the other
let gl = null, parts = null;

const arrayOf = (made, layout, each) => {
  const stride = 4 * layout.reduce((sum, [, size]) => sum + size, 0);
  let at = 0;
  gl.bindBuffer(gl.ARRAY_BUFFER, made);
  for (const [location, size] of layout) {
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, stride, at);
    gl.vertexAttribDivisor(location, each);
    at += 4 * size;
  }
};

const VERTEX = [[0, 3], [1, 3], [2, 1]];
const makeVertices = (buffer, numbers, use) => {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  const made = buffer(gl.ARRAY_BUFFER, new Float32Array(numbers), use);
  arrayOf(made, VERTEX, 0);
  return {array, made, count: numbers.length / 7};
};

const makeRounds = (buffer, numbers, round) => {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  arrayOf(buffer(gl.ARRAY_BUFFER, round.points, gl.STATIC_DRAW), [[0, 4]], 0);
  arrayOf(buffer(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW), [[1, 3], [2, 3], [3, 3]], 1);
  buffer(gl.ELEMENT_ARRAY_BUFFER, round.corners, gl.STATIC_DRAW);
  return {array, corners: round.corners.length, count: numbers.length / 9};
};

const makePass = (buffer, isSensor) => {
  const to = {faces: [], lines: [], rounds: []};
  for (const shape of bodies.shapes)
    if (shape.isSensor === isSensor && !shape.isPlane) (fp3.isFlat ? addFlat : addSolid)(to, shape);
  const ways = to.rounds.length > 9 * 2000 ? 12 : to.rounds.length > 9 * 200 ? 24 : 48;
  return {isSensor, faces: makeVertices(buffer, to.faces, gl.STATIC_DRAW), lines: makeVertices(buffer, to.lines, gl.STATIC_DRAW),
    rounds: makeRounds(buffer, to.rounds, roundOf(ways))};
};

if (bodies) {
  bodies.planes = bodies.shapes.filter(shape => shape.isPlane && !fp3.isFlat);
  const types = new Map(bodies.shapes.map(shape => [shape.object, shape.type]));
  const slots = count + bodies.planes.length, data = new Float32Array(4 * WIDE * Math.ceil(3 * slots / WIDE));

  bodies.make = (context, link, buffer) => {
    gl = context;
    parts = {faces: link(fp3.faceVertex, fp3.bodyFragment), rounds: link(fp3.roundVertex, fp3.bodyFragment),
      passes: [makePass(buffer, true), makePass(buffer, false)], planes: makeVertices(buffer, [], gl.DYNAMIC_DRAW), poses: gl.createTexture()};
    gl.bindTexture(gl.TEXTURE_2D, parts.poses);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, WIDE, data.length / 4 / WIDE);
  };

  // Static bodies are grey, and those that sleep paler than those that are awake.
  const paleOf = (snapshot, object) => types.get(object) !== 2 && bodies.asleep >= 0 &&
    fp3.value(about.columns[bodies.asleep], snapshot * count + object) < 0 ? 0.6 : 0.3;
  const fullOf = (look, object) => object === look.picked ? look.colours.mark : types.get(object) === 2 ? [0.5, 0.5, 0.5] : look.colourOf(object);

  const fill = look => {
    posesAt(look.snapshot);
    poses.forEach(({x, q}, i) => {
      const at = toWorld(x), isThere = [...at, ...q].every(Number.isFinite);
      data.set(isThere ? [...at, 1, ...q] : [0, 0, 0, 0, 1, 0, 0, 0], 12 * i);
      data.set([...fullOf(look, i), paleOf(look.snapshot, i)], 12 * i + 8);
    });
    const list = [];
    bodies.planes.forEach((shape, i) => {
      addPlane(list, shape, i);
      data.set([0, 0, 0, 1, 1, 0, 0, 0, ...fullOf(look, shape.object), 0.6], 12 * (count + i));
    });
    gl.bindTexture(gl.TEXTURE_2D, parts.poses);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDE, data.length / 4 / WIDE, gl.RGBA, gl.FLOAT, data);
    gl.bindBuffer(gl.ARRAY_BUFFER, parts.planes.made);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(list), gl.DYNAMIC_DRAW);
    parts.planes.count = list.length / 7;
  };

  const begin = ({program, uniforms}, look, isSensor, rim) => {
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.view, false, camera.view);
    gl.uniformMatrix4fv(uniforms.project, false, camera.project);
    gl.uniform1f(uniforms.scale, world.scale[0]);
    gl.uniform3fv(uniforms.back, look.colours.back);
    gl.uniform4f(uniforms.rim, ...look.colours.ink, rim);
    gl.uniform1f(uniforms.pale, isSensor && fp3.isFlat ? 0.8 : -1);
    gl.uniform1f(uniforms.cover, isSensor && !fp3.isFlat && !look.isPicking ? 0.3 : 1);
    gl.uniform1i(uniforms.isPicking, look.isPicking ? 1 : 0);
  };

  const drawVertices = (kind, {array, count: vertices}) => {
    gl.bindVertexArray(array);
    gl.drawArrays(kind, 0, vertices);
  };

  const drawPass = (pass, look) => {
    gl.depthMask(!pass.isSensor);
    gl[fp3.isFlat ? "disable" : "enable"](gl.CULL_FACE);
    gl.enable(gl.POLYGON_OFFSET_FILL); // lines are before faces
    gl.polygonOffset(1, 1);
    begin(parts.faces, look, pass.isSensor, 0);
    drawVertices(gl.TRIANGLES, pass.faces);
    if (!pass.isSensor) drawVertices(gl.TRIANGLES, parts.planes);
    begin(parts.rounds, look, pass.isSensor, 0);
    gl.bindVertexArray(pass.rounds.array);
    gl.drawElementsInstanced(gl.TRIANGLES, pass.rounds.corners, gl.UNSIGNED_SHORT, 0, pass.rounds.count);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.disable(gl.CULL_FACE);
    begin(parts.faces, look, pass.isSensor, 0.5);
    if (!look.isPicking) drawVertices(gl.LINES, pass.lines);
    gl.depthMask(true);
  };

  // look: the snapshot, the colours, colourOf an object, who is picked; isPicking: numbers of objects instead of colours.
  bodies.draw = look => {
    fill(look);
    gl.depthFunc(gl.LEQUAL); // in a plane what comes later is in front
    const sensorsFirst = fp3.isFlat || look.isPicking; // in space others are seen through them
    for (const pass of sensorsFirst ? parts.passes : [...parts.passes].reverse()) drawPass(pass, look);
    gl.depthFunc(gl.LESS);
  };

  bodies.objectOf = slot => slot < count ? slot : bodies.planes[slot - count].object;
  bodies.ends = (joint, snapshot) => joint.anchors.map((anchor, i) => placed(posesAt(snapshot)[joint.of[i]], anchor));
}
