// SPDX-License-Identifier: Apache-2.0
// Curves over time of the picked object, and the names and numbers along the axes.
const {about, camera, world, axes, scene} = fp3;
const list = document.getElementById("plots");
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const plots = {rows: []};
fp3.plots = plots;

const sized = canvas => {
  const ratio = devicePixelRatio, width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  return canvas.getContext("2d");
};

// ---- one state ----

const make = column => {
  const row = {column, figure: document.createElement("figure"), caption: document.createElement("figcaption"), name: document.createElement("b"),
    now: document.createElement("output"), canvas: document.createElement("canvas")};
  row.name.textContent = fp3.named(column.name, column.unit);
  if (column.doc) row.name.title = column.doc;
  row.canvas.setAttribute("role", "img");
  row.caption.append(row.name, row.now);
  row.figure.append(row.caption, row.canvas);
  row.canvas.addEventListener("pointerdown", event => {
    const jump = where => fp3.go(Math.round((where.offsetX / row.canvas.clientWidth) * (about.snapshots - 1)));
    jump(event);
    row.canvas.setPointerCapture(event.pointerId);
    row.canvas.onpointermove = jump;
    row.canvas.onpointerup = row.canvas.onpointercancel = () => { row.canvas.onpointermove = null; };
  });
  return row;
};

const range = (column, object) => {
  let least = Infinity, most = -Infinity;
  for (let n = 0; n < fp3.loaded; n++) {
    const value = fp3.value(column, n * about.objects + object);
    if (Number.isFinite(value)) [least, most] = [Math.min(least, value), Math.max(most, value)];
  }
  return {least, most};
};

// For each pixel the least and the most that is there, so that no peak is lost.
const curve = (row, width, height) => {
  const path = new Path2D(), {least, most} = row.range, pad = 4 * devicePixelRatio;
  const y = value => most > least ? height - pad - (value - least) / (most - least) * (height - 2 * pad) : height / 2;
  const last = Math.max(1, about.snapshots - 1);
  let isOpen = false, pixel = -1, low = 0, high = 0;
  const flush = () => {
    if (low !== high) { path.lineTo(pixel, y(low)); path.lineTo(pixel, y(high)); }
  };
  for (let n = 0; n < fp3.loaded; n++) {
    const value = fp3.value(row.column, n * about.objects + scene.picked), x = n / last * width;
    if (!Number.isFinite(value)) { isOpen = false; continue; }
    if (isOpen && Math.floor(x) === Math.floor(pixel)) {
      [low, high] = [Math.min(low, value), Math.max(high, value)];
      continue;
    }
    if (isOpen) { flush(); path.lineTo(x, y(value)); } else path.moveTo(x, y(value));
    [isOpen, pixel, low, high] = [true, x, value, value];
  }
  if (isOpen) flush();
  return path;
};

// Over the curve, and legible.
const write = (pen, text, y) => {
  const ratio = devicePixelRatio;
  pen.globalAlpha = 0.75;
  pen.fillStyle = css("--back");
  pen.fillRect(2 * ratio, y - 11 * ratio, pen.measureText(text).width + 4 * ratio, 14 * ratio);
  pen.globalAlpha = 1;
  pen.fillStyle = css("--soft");
  pen.fillText(text, 4 * ratio, y);
};

const drawRow = row => {
  const canvas = row.canvas, pen = sized(canvas), {width, height} = canvas;
  const key = [scene.picked, width, height, fp3.loaded].join();
  if (row.key !== key) {
    row.range = range(row.column, scene.picked);
    row.path = curve(row, width, height);
    row.key = key;
  }
  pen.clearRect(0, 0, width, height);
  pen.lineWidth = 1.5 * devicePixelRatio;
  pen.strokeStyle = css("--focus");
  pen.stroke(row.path);
  const x = scene.snapshot / Math.max(1, about.snapshots - 1) * width;
  pen.strokeStyle = css("--accent");
  pen.lineWidth = devicePixelRatio;
  pen.beginPath();
  pen.moveTo(x, 0);
  pen.lineTo(x, height);
  pen.stroke();
  pen.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  if (row.range.most > row.range.least) {
    write(pen, fp3.number(row.range.most, 4), 13 * devicePixelRatio);
    write(pen, fp3.number(row.range.least, 4), height - 5 * devicePixelRatio);
  }
};

const say = row => {
  const {column} = row, value = fp3.value(column, scene.snapshot * about.objects + scene.picked);
  const bound = column.bound > 0 && Number.isFinite(value) ? ` ± ${fp3.number(column.bound, 2)}` : "";
  row.now.textContent = fp3.withUnit(fp3.number(value, column.isFloat ? 9 : 6) + bound, column.unit);
  row.canvas.setAttribute("aria-label", `${column.name} over time, now ${row.now.textContent}`);
};

plots.pick = object => {
  const panel = document.getElementById("panel");
  panel.hidden = object < 0;
  document.getElementById("picked").textContent = object < 0 ? "" : `Object ${object}`;
  if (object >= 0 && !plots.rows.length) {
    plots.rows = [...axes, ...about.columns.filter(column => !axes.includes(column))].map(make);
    list.append(...plots.rows.map(row => row.figure));
  }
};

plots.draw = () => {
  if (scene.picked < 0) return;
  for (const row of plots.rows) {
    say(row);
    drawRow(row);
  }
};

// ---- axes ----

const labels = document.getElementById("labels");

// Of the four edges along an axis the lowest one in the picture; along the one that points up, the one to the left.
const outerEdge = k => {
  const [a, b] = [(k + 1) % 3, (k + 2) % 3];
  const pointsUp = k === (fp3.isFlat ? 1 : camera.up);
  let best = null;
  for (let corner = 0; corner < 4; corner++) {
    const ends = [0, 1].map(end => {
      const point = [0, 0, 0];
      point[k] = scene.frameBox[k][end];
      point[a] = scene.frameBox[a][corner & 1];
      point[b] = scene.frameBox[b][corner >> 1];
      return camera.see(...point);
    });
    const middle = {x: (ends[0].x + ends[1].x) / 2, y: (ends[0].y + ends[1].y) / 2};
    const score = pointsUp ? -middle.x : middle.y;
    if (!best || score > best.score) best = {score, ends, middle};
  }
  return best;
};

plots.label = () => {
  const pen = sized(labels), {width, height} = labels, ratio = devicePixelRatio;
  pen.clearRect(0, 0, width, height);
  if (!scene.frame || !camera.view) return;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  axes.forEach((column, k) => {
    if (world.half[k] <= 0) return;
    const {ends, middle} = outerEdge(k);
    const out = {x: (middle.x - 0.5) * width, y: (middle.y - 0.5) * height}, long = Math.hypot(out.x, out.y) || 1;
    const put = (text, at, away, font) => {
      pen.font = `${font} ${12 * ratio}px system-ui, sans-serif`;
      const room = pen.measureText(text).width / 2 + 4 * ratio;
      const x = at.x * width + out.x / long * (away + room * Math.abs(out.x / long)), y = at.y * height + out.y / long * away;
      if (Number.isFinite(x + y)) pen.fillText(text, Math.min(width - room, Math.max(room, x)), Math.min(height - 8 * ratio, Math.max(8 * ratio, y)));
    };
    pen.fillStyle = css("--soft");
    // Not at the very ends, where those of other axes are.
    const inner = share => ({x: ends[0].x + share * (ends[1].x - ends[0].x), y: ends[0].y + share * (ends[1].y - ends[0].y)});
    const inset = fp3.isFlat ? 0 : 0.12;
    if (height > 260 * ratio) put(fp3.number(world.ends[k][0], 3), inner(inset), 12 * ratio, "normal");
    if (height > 260 * ratio) put(fp3.number(world.ends[k][1], 3), inner(1 - inset), 12 * ratio, "normal");
    pen.fillStyle = css("--text");
    put(fp3.named(column.name, column.unit), middle, 16 * ratio, "bold");
  });
};
