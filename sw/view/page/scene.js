// SPDX-License-Identifier: Apache-2.0
// Draws a snapshot with WebGL: objects, links, trails, walls, axes.
const {about, bodies, camera, world, axes} = fp3;
const canvas = document.getElementById("scene");
const gl = canvas.getContext("webgl2", {antialias: true, alpha: false});
const count = about.objects;
const life = about.columns.find(column => column.name === "life");
const scene = {links: true, trails: count <= 8 && !bodies, frame: true, field: null, picked: -1, snapshot: 0};
fp3.scene = scene;

// ---- which objects are there ----

const isShown = (snapshot, object) => {
  const at = snapshot * count + object;
  return axes.every(column => Number.isFinite(fp3.value(column, at))) && !(life && fp3.value(life, at) !== 1);
};
scene.isShown = isShown;
const mayHide = life !== undefined || axes.some(column => column.hasHoles);

// ---- the parts ----

const palette = () => {
  const isDark = document.documentElement.dataset.theme === "dark";
  return isDark ? {back: [0.063, 0.075, 0.106], plain: [0.45, 0.66, 1], mark: [1, 0.54, 0.4], ink: [0.75, 0.8, 0.9]}
    : {back: [0.933, 0.941, 0.957], plain: [0.14, 0.34, 0.77], mark: [0.75, 0.1, 0.08], ink: [0.2, 0.24, 0.34]};
};

const compile = (kind, text) => {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
};

const attributes = ["px", "py", "pz", "tint", "hide", "size", "corner"];

const link = (vertex, fragment) => {
  const program = gl.createProgram(), uniforms = {};
  gl.attachShader(program, compile(gl.VERTEX_SHADER, vertex));
  gl.attachShader(program, compile(gl.FRAGMENT_SHADER, fragment));
  attributes.forEach((name, i) => gl.bindAttribLocation(program, i, name));
  gl.linkProgram(program);
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
    const name = gl.getActiveUniform(program, i).name;
    uniforms[name.replace("[0]", "")] = gl.getUniformLocation(program, name);
  }
  return {program, uniforms};
};

const buffer = (kind, data, use) => {
  const made = gl.createBuffer();
  gl.bindBuffer(kind, made);
  gl.bufferData(kind, data, use);
  return made;
};

let parts = null;

// Objects' values as attributes: one of each ball, or one of each end of a line.
const pointAt = isBall => {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  parts.values.forEach((made, i) => {
    if (!made) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, made.buffer);
    gl.enableVertexAttribArray(i);
    gl.vertexAttribPointer(i, 1, made.kind, made.isNormal, 0, 0);
    gl.vertexAttribDivisor(i, isBall ? 1 : 0);
  });
  if (isBall) {
    gl.bindBuffer(gl.ARRAY_BUFFER, parts.corners);
    gl.enableVertexAttribArray(6);
    gl.vertexAttribPointer(6, 2, gl.FLOAT, false, 0, 0);
  }
  return array;
};

const positionBuffer = column => column && {
  buffer: buffer(gl.ARRAY_BUFFER, column.codes.BYTES_PER_ELEMENT * count, gl.DYNAMIC_DRAW),
  kind: column.isFloat ? gl.FLOAT : gl.UNSIGNED_SHORT, isNormal: !column.isFloat,
};

const floats = () => ({buffer: buffer(gl.ARRAY_BUFFER, 4 * count, gl.DYNAMIC_DRAW), kind: gl.FLOAT, isNormal: false});

const make = () => {
  parts = {balls: link(fp3.ballVertex, fp3.ballFragment), lines: link(fp3.lineVertex, fp3.lineFragment)};
  parts.corners = buffer(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), gl.STATIC_DRAW);
  parts.values = [positionBuffer(axes[0]), positionBuffer(axes[1]), positionBuffer(axes[2]), floats(),
    mayHide ? {buffer: buffer(gl.ARRAY_BUFFER, count, gl.DYNAMIC_DRAW), kind: gl.UNSIGNED_BYTE, isNormal: false} : null,
    about.radiusOf >= 0 ? floats() : null];
  parts.ballArray = pointAt(true);
  parts.endArray = pointAt(false);
  parts.loose = buffer(gl.ARRAY_BUFFER, 0, gl.DYNAMIC_DRAW);
  parts.looseArray = gl.createVertexArray();
  gl.bindVertexArray(parts.looseArray);
  gl.bindBuffer(gl.ARRAY_BUFFER, parts.loose);
  for (let k = 0; k < 3; k++) {
    gl.enableVertexAttribArray(k);
    gl.vertexAttribPointer(k, 1, gl.FLOAT, false, 12, 4 * k);
  }
  if (bodies) bodies.make(gl, link, buffer);
  parts.pairs = scene.pairs ? index(scene.pairs) : null;
  parts.filled = -1;
};

const index = pairs => {
  gl.bindVertexArray(parts.endArray);
  return buffer(gl.ELEMENT_ARRAY_BUFFER, pairs, gl.STATIC_DRAW);
};

scene.setPairs = pairs => {
  scene.pairs = pairs;
  if (parts) parts.pairs = index(pairs);
};

// ---- a snapshot's values ----

const tints = new Float32Array(count), sizes = new Float32Array(count), hides = new Uint8Array(count);

const fillTints = snapshot => {
  const field = scene.field;
  if (!field) return tints.fill(-1);
  const least = field.least, width = field.most - field.least;
  for (let i = 0; i < count; i++) {
    const value = fp3.fieldValue(field, snapshot * count + i);
    tints[i] = Number.isFinite(value) ? (width > 0 ? Math.min(1, Math.max(0, (value - least) / width)) : 0.5) : -2;
  }
};

const put = (i, data) => {
  gl.bindBuffer(gl.ARRAY_BUFFER, parts.values[i].buffer);
  gl.bufferSubData(gl.ARRAY_BUFFER, 0, data);
};

const fill = snapshot => {
  axes.forEach((column, k) => put(k, column.codes.subarray(snapshot * count, (snapshot + 1) * count)));
  fillTints(snapshot);
  put(3, tints);
  if (mayHide) {
    for (let i = 0; i < count; i++) hides[i] = isShown(snapshot, i) ? 0 : 1;
    put(4, hides);
  }
  if (about.radiusOf >= 0) {
    for (let i = 0; i < count; i++) sizes[i] = Math.max(0, fp3.value(about.columns[about.radiusOf], snapshot * count + i) || 0);
    put(5, sizes);
  }
};

scene.changed = () => { if (parts) parts.filled = -1; };

// ---- drawing ----

// World = (value - C) * A + B, where an attribute of 16 bits comes as a number from 0 to 1. B is for what is the same everywhere.
const maps = () => {
  const A = [1, 1, 1], B = [0, 0, 0], C = [0, 0, 0];
  axes.forEach((column, k) => {
    const step = column.isFloat ? 1 : column.step * 65535, low = column.isFloat ? 0 : column.low;
    A[k] = step * world.scale[k];
    if (step > 0) C[k] = (world.middle[k] - low) / step;
    else B[k] = world.of(k, low);
  });
  return {A, B, C};
};
const mapped = maps();

const begin = (part, colours) => {
  const u = part.uniforms;
  gl.useProgram(part.program);
  gl.uniformMatrix4fv(u.view, false, camera.view);
  gl.uniformMatrix4fv(u.project, false, camera.project);
  gl.uniform3fv(u.stops, fp3.stops.flat().map(x => x / 255));
  gl.uniform3fv(u.plain, colours.plain);
  if (u.mark) gl.uniform3fv(u.mark, colours.mark);
  return u;
};

const place = (u, isLoose) => {
  gl.uniform3fv(u.A, isLoose ? [1, 1, 1] : mapped.A);
  gl.uniform3fv(u.B, isLoose ? [0, 0, 0] : mapped.B);
  gl.uniform3fv(u.C, isLoose ? [0, 0, 0] : mapped.C);
};

scene.least = () => (count <= 100 ? 5 : count <= 2000 ? 3.2 : count <= 20000 ? 2 : 1.4) * devicePixelRatio; // pixels

const drawBalls = colours => {
  const u = begin(parts.balls, colours);
  const hasRadius = about.radius > 0 || about.radiusOf >= 0;
  place(u, false);
  gl.uniform2f(u.pixels, canvas.width, canvas.height);
  gl.uniform1f(u.radius, hasRadius ? (about.radius || 1) * world.scale[0] : 0);
  gl.uniform1f(u.least, hasRadius ? 0.75 * devicePixelRatio : scene.least());
  gl.uniform1i(u.picked, scene.picked);
  gl.bindVertexArray(parts.ballArray);
  gl.vertexAttrib1f(5, 1);
  gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
};

const drawLinks = colours => {
  const u = begin(parts.lines, colours);
  place(u, false);
  gl.uniform4f(u.ink, ...colours.ink, 0.55);
  gl.uniform1f(u.mixed, 0.8);
  gl.bindVertexArray(parts.endArray);
  gl.drawElements(gl.LINES, scene.pairs.length, gl.UNSIGNED_INT, 0);
};

// ---- bodies ----

// As the graphics colour balls.
const colourOf = (object, colours) => {
  const t = tints[object], stop = Math.min(4, Math.floor(5 * Math.max(0, t)));
  if (t < 0) return t < -1.5 ? [0.5, 0.5, 0.5] : colours.plain;
  return fp3.stops[stop].map((x, k) => (x + (fp3.stops[stop + 1][k] - x) * (5 * t - stop)) / 255);
};

const lookAt = (colours, isPicking) => ({snapshot: scene.snapshot, picked: scene.picked, colours, isPicking, colourOf: object => colourOf(object, colours)});

// What pixels are as a length of the world.
const pixels = n => n * devicePixelRatio * 2 * camera.high / canvas.height;

// Beside a point, across the view.
const beside = (point, right, up) => point.map((x, k) => x + pixels(right) * camera.view[4 * k] + pixels(up) * camera.view[4 * k + 1]);
const cross = point => [[-3, 0], [3, 0], [0, -3], [0, 3]].flatMap(way => beside(point, ...way));

const jointLines = () => bodies.joints.filter(joint => scene.snapshot < joint.snapshots).flatMap(joint => {
  const [a, b] = bodies.ends(joint, scene.snapshot);
  return [...a, ...b, ...cross(a), ...cross(b)];
});

// A line is as long as the root of the force, as in pictures.
const contactLines = () => bodies.contacts.filter(([snapshot]) => snapshot === scene.snapshot).flatMap(([, ...c]) => {
  const from = [0, 1, 2].map(k => k < axes.length ? world.of(k, c[k]) : 0), long = bodies.most > 0 ? pixels(60) * Math.sqrt(Math.max(0, c[6]) / bodies.most) : 0;
  return [...from, ...from.map((x, k) => x + long * c[3 + k]), ...cross(from)];
});

// In space marks are before all bodies.
const drawBodies = colours => {
  bodies.draw(lookAt(colours, false));
  gl.depthFunc(fp3.isFlat ? gl.LEQUAL : gl.ALWAYS);
  if (scene.links) drawLoose(gl.LINES, jointLines(), [...colours.mark, 1]);
  drawLoose(gl.LINES, contactLines(), [0.85, 0.53, 0.1, 1]);
  gl.depthFunc(gl.LESS);
};

// Points of the world, three numbers each.
const drawLoose = (kind, points, ink) => {
  if (!points.length) return;
  const u = begin(parts.lines, palette());
  place(u, true);
  gl.uniform4f(u.ink, ...ink);
  gl.uniform1f(u.mixed, 0);
  gl.bindVertexArray(parts.looseArray);
  gl.bindBuffer(gl.ARRAY_BUFFER, parts.loose);
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points), gl.DYNAMIC_DRAW);
  gl.vertexAttrib1f(3, -1);
  gl.drawArrays(kind, 0, points.length / 3);
};

// The edges of a box by its ends along each axis.
const edges = box => {
  const points = [];
  for (let k = 0; k < 3; k++)
    for (let corner = 0; corner < 4; corner++)
      for (let end = 0; end < 2; end++) {
        const point = [0, 0, 0];
        point[k] = box[k][end];
        point[(k + 1) % 3] = box[(k + 1) % 3][corner & 1];
        point[(k + 2) % 3] = box[(k + 2) % 3][corner >> 1];
        points.push(...point);
      }
  return points;
};

const frameBox = [0, 1, 2].map(k => [-world.half[k], world.half[k]]);
scene.frameBox = frameBox;

const plane = ({axis, at}) => {
  const [a, b] = [(axis + 1) % 3, (axis + 2) % 3], where = world.of(axis, at);
  return [[0, 0], [1, 0], [0, 1], [1, 1]].flatMap(([i, j]) => {
    const point = [0, 0, 0];
    point[axis] = where;
    point[a] = frameBox[a][i];
    point[b] = frameBox[b][j];
    return point;
  });
};

const drawWalls = colours => {
  if (about.box.length)
    drawLoose(gl.LINES, edges([0, 1, 2].map(k => k < axes.length ? [world.of(k, about.box[k]), world.of(k, about.box[3 + k])] : [0, 0])), [...colours.ink, 1]);
  for (const wall of about.planes) {
    const p = plane(wall), outline = [0, 1, 3, 2, 0].flatMap(i => p.slice(3 * i, 3 * i + 3));
    drawLoose(gl.LINE_STRIP, outline, [...colours.ink, 0.9]);
    if (fp3.isFlat) continue;
    gl.depthMask(false);
    drawLoose(gl.TRIANGLE_STRIP, p, [...colours.ink, 0.16]);
    gl.depthMask(true);
  }
};

// From the first snapshot to this one; what is not there leaves a gap.
const trail = object => {
  const parts = [[]];
  for (let n = 0; n <= scene.snapshot; n++) {
    if (!isShown(n, object)) {
      parts.push([]);
      continue;
    }
    for (let k = 0; k < 3; k++)
      parts.at(-1).push(k < axes.length ? world.of(k, fp3.value(axes[k], n * count + object)) : 0);
  }
  return parts.filter(points => points.length);
};

const TRAILS = 32;
const drawTrails = colours => {
  if (scene.trails)
    for (let i = 0; i < Math.min(count, TRAILS); i++) // of many objects that of the picked one says more
      if (count <= TRAILS && i !== scene.picked) for (const points of trail(i)) drawLoose(gl.LINE_STRIP, points, [...colours.ink, 0.7]);
  if (scene.picked >= 0 && (scene.trails || count > TRAILS)) for (const points of trail(scene.picked)) drawLoose(gl.LINE_STRIP, points, [...colours.mark, 1]);
};

scene.draw = () => {
  const colours = palette();
  if (parts.filled !== scene.snapshot) fill(scene.snapshot);
  parts.filled = scene.snapshot;
  camera.matrices(canvas.width / canvas.height);
  gl.viewport(0, 0, canvas.width, canvas.height);
  gl.clearColor(...colours.back, 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  if (bodies) drawBodies(colours);
  else drawBalls(colours);
  if (scene.links && parts.pairs) drawLinks(colours);
  drawTrails(colours);
  if (scene.frame) drawLoose(gl.LINES, edges(frameBox), [...colours.ink, 0.3]);
  drawWalls(colours);
};

// ---- picking ----

// The graphics draw numbers instead of colours, in the one pixel that is asked for.
const bodyAt = (x, y) => {
  const pixel = new Uint8Array(4), [column, row] = [Math.floor(x * devicePixelRatio), canvas.height - 1 - Math.floor(y * devicePixelRatio)];
  const frame = gl.createFramebuffer(), stores = [[gl.COLOR_ATTACHMENT0, gl.RGBA8], [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24]].map(([point, form]) => {
    const store = gl.createRenderbuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.bindRenderbuffer(gl.RENDERBUFFER, store);
    gl.renderbufferStorage(gl.RENDERBUFFER, form, canvas.width, canvas.height);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, point, gl.RENDERBUFFER, store);
    return store;
  });
  gl.enable(gl.SCISSOR_TEST);
  gl.scissor(column, row, 1, 1);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  bodies.draw(lookAt(palette(), true));
  gl.readPixels(column, row, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  gl.disable(gl.SCISSOR_TEST);
  gl.deleteFramebuffer(frame);
  for (const store of stores) gl.deleteRenderbuffer(store);
  return pixel[3] ? bodies.objectOf(pixel[0] + 256 * pixel[1] + 65536 * pixel[2]) : -1;
};

// The nearest object under a point of the picture (pixels of the page), or -1.
scene.at = (x, y) => {
  if (bodies) return bodyAt(x, y);
  const high = canvas.clientHeight, wide = canvas.clientWidth;
  let best = -1, bestScore = Infinity;
  for (let i = 0; i < count; i++) {
    const at = scene.snapshot * count + i;
    if (mayHide && !isShown(scene.snapshot, i)) continue;
    const p = axes.map((column, k) => world.of(k, fp3.value(column, at)));
    const seen = camera.see(p[0], p[1] || 0, p[2] || 0);
    const own = about.radiusOf >= 0 ? fp3.value(about.columns[about.radiusOf], at) : about.radius;
    const radius = Math.max(own * world.scale[0] * seen.size * high, scene.least() / devicePixelRatio) || 0;
    const off = Math.hypot(seen.x * wide - x, seen.y * high - y);
    if (seen.away <= 0 && !fp3.isFlat || off > radius + 6) continue;
    // Inside: the nearest to the eye. Beside: the least far from the edge.
    const score = off <= radius ? seen.away - 1e6 : off - radius;
    if (score < bestScore) [best, bestScore] = [i, score];
  }
  return best;
};

// ---- the context ----

if (!gl) fp3.fail(new Error("This browser has no WebGL 2, which draws the objects."));
canvas.addEventListener("webglcontextlost", event => {
  event.preventDefault();
  parts = null;
});
canvas.addEventListener("webglcontextrestored", () => {
  make();
  fp3.redraw();
});
scene.isReady = () => gl !== null && parts !== null;
try {
  if (gl) make();
} catch (error) {
  fp3.fail(error);
}
