// SPDX-License-Identifier: Apache-2.0
// Curves on a canvas: lines = [{xs, ys, colour}], with the names and ends of both axes.
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const number = (value, digits) => Number.isFinite(value) ? String(Number(value.toPrecision(digits))) : String(value);
// Eight that everybody tells apart (Okabe and Ito), the dark one in the colour of the text.
const colours = () => [css("--focus"), "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", css("--text"), "#b8a900"];

const ends = (lines, of) => {
  let least = Infinity, most = -Infinity;
  for (const line of lines)
    for (const value of line[of])
      if (Number.isFinite(value)) [least, most] = [Math.min(least, value), Math.max(most, value)];
  const pad = most > least ? 0.04 * (most - least) : Math.abs(least) || 1;
  return least > most ? null : {least, most, from: least - pad, size: most - least + 2 * pad};
};

const plot = (canvas, lines, across, up) => {
  const ratio = devicePixelRatio, width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  const pen = canvas.getContext("2d"), x = ends(lines, "xs"), y = ends(lines, "ys");
  pen.clearRect(0, 0, width, height);
  if (!x || !y) return;
  const left = 8 * ratio, low = height - 20 * ratio, wide = width - 2 * left, high = low - 8 * ratio;
  const place = (at, axis, from, size) => from + (at - axis.from) / axis.size * size;
  pen.lineWidth = ratio;
  pen.strokeStyle = css("--line");
  pen.strokeRect(left, low - high, wide, high);
  if (y.from < 0 && y.from + y.size > 0) {
    pen.beginPath();
    pen.moveTo(left, place(0, y, low, -high));
    pen.lineTo(left + wide, place(0, y, low, -high));
    pen.stroke();
  }
  pen.lineWidth = 1.5 * ratio;
  pen.lineJoin = "round";
  for (const {xs, ys, colour} of lines) {
    let isOpen = false;
    pen.strokeStyle = colour;
    pen.beginPath();
    for (let i = 0; i < xs.length; i++) {
      const isThere = Number.isFinite(xs[i]) && Number.isFinite(ys[i]);
      if (isThere) pen[isOpen ? "lineTo" : "moveTo"](place(xs[i], x, left, wide), place(ys[i], y, low, -high));
      isOpen = isThere;
    }
    pen.stroke();
  }
  const write = (text, at, line, align) => {
    pen.textAlign = align;
    pen.globalAlpha = 0.8;
    pen.fillStyle = css("--back");
    const room = pen.measureText(text).width + 4 * ratio;
    pen.fillRect(align === "left" ? at - 2 * ratio : align === "right" ? at - room + 2 * ratio : at - room / 2, line - 11 * ratio, room, 14 * ratio);
    pen.globalAlpha = 1;
    pen.fillStyle = css("--text");
    pen.fillText(text, at, line);
  };
  pen.font = `${11.5 * ratio}px system-ui, sans-serif`;
  write(number(x.least, 4), left, height - 6 * ratio, "left");
  write(number(x.most, 4), width - left, height - 6 * ratio, "right");
  write(across, width / 2, height - 6 * ratio, "center");
  write(number(y.most, 4), left + 4 * ratio, low - high + 14 * ratio, "left");
  write(number(y.least, 4), left + 4 * ratio, low - 6 * ratio, "left");
  if (up) write(up, left + 4 * ratio, low - high / 2, "left");
};
