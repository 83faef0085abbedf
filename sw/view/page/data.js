// SPDX-License-Identifier: Apache-2.0
// The numbers of the recording: unpacked piece by piece, as the browser reads the file. sw/view/pack.h says how they are packed.
const HOLE = 65535;
const about = JSON.parse(document.getElementById("about").textContent);
const total = about.objects * about.snapshots;

fp3.about = about;
fp3.loaded = 0; // snapshots
fp3.listeners = [];

fp3.fail = error => {
  document.getElementById("message").textContent = error.message || String(error);
};

for (const column of about.columns)
  column.codes = column.isFloat ? new Float32Array(total) : new Uint16Array(total);

const bytesOf = text => {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const signs = atob(text), bytes = new Uint8Array(signs.length);
  for (let i = 0; i < signs.length; i++) bytes[i] = signs.charCodeAt(i);
  return bytes;
};

const inflate = async text => {
  if (!window.DecompressionStream) throw new Error("This browser has no DecompressionStream, which unpacks the numbers.");
  const stream = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};

// An unsigned array wraps as the differences do.
const undo = (planes, rows, count, to, at) => {
  const size = rows * count, isWide = to.BYTES_PER_ELEMENT === 4, order = planes[0];
  for (let i = 0; i < size; i++) {
    let code = planes[1 + i] | planes[1 + size + i] << 8;
    if (isWide) code |= planes[1 + 2 * size + i] << 16 | planes[1 + 3 * size + i] << 24;
    const difference = (code >>> 1) ^ -(code & 1), here = at + i;
    let expected = 0;
    if (i < count) expected = i ? to[here - 1] : 0;
    else if (i < 2 * count || order === 1) expected = to[here - count];
    else expected = 2 * to[here - count] - to[here - 2 * count];
    to[here] = expected + difference;
  }
};

// The text is not needed any more.
const take = id => {
  const element = document.getElementById(id), text = element.textContent;
  element.remove();
  return text;
};

const unpackColumn = async (text, column, first, rows) => {
  const codes = column.isFloat ? new Uint32Array(column.codes.buffer) : column.codes;
  undo(await inflate(text), rows, about.objects, codes, first * about.objects);
};

let first = 0, work = Promise.resolve();

fp3.unpack = number => {
  const from = first, rows = about.chunks[number];
  const texts = about.columns.map((column, i) => take(`d${number}-${i}`));
  first += rows;
  work = work.then(() => Promise.all(about.columns.map((column, i) => unpackColumn(texts[i], column, from, rows)))).then(() => {
    fp3.loaded = from + rows;
    for (const listener of fp3.listeners) listener();
  }).catch(fp3.fail);
};

fp3.end = () => {
  if (first !== about.snapshots) fp3.fail(new Error("This file is not complete."));
};

fp3.pairs = async (number, count) => {
  const pairs = new Uint32Array(2 * count);
  undo(await inflate(take(`l${number}`)), 1, 2 * count, pairs, 0);
  return pairs;
};

// ---- what the numbers mean ----

fp3.value = (column, at) => {
  const code = column.codes[at];
  if (column.isFloat) return code;
  return code === HOLE ? NaN : column.low + code * column.step;
};

fp3.fieldValue = (field, at) => {
  if (field.columns.length === 1) return fp3.value(about.columns[field.columns[0]], at);
  let sum = 0;
  for (const k of field.columns) sum += fp3.value(about.columns[k], at) ** 2;
  return Math.sqrt(sum);
};

fp3.step = snapshot => Array.isArray(about.steps) ? about.steps[snapshot] :
  Math.min(about.steps.first + snapshot * about.steps.every, about.steps.last);

// null: the recording has no time.
fp3.time = snapshot => about.times === null ? null :
  Array.isArray(about.times) ? about.times[snapshot] : fp3.step(snapshot) * about.times.h;

// Few digits, as people write them.
fp3.number = (value, digits = 5) => {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "not finite" : value > 0 ? "∞" : "-∞";
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
};

fp3.withUnit = (text, unit) => unit ? `${text} ${unit}` : text;
fp3.named = (name, unit) => unit ? `${name} [${unit}]` : name;
