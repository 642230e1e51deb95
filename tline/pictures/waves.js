const end = data.marks[data.marks.length - 1][0], shown = {u: true, a: !data.bounds.length, b: !data.bounds.length};
const scaled = ([low, high]) => count => low + count / data.steps * (high - low);
const level = scaled(data.range), wave = scaled(data.wave_range);
let bottom, top_;

function limits() {
  const ranges = [...shown.u || !(shown.a || shown.b) ? [data.range] : [], ...shown.a || shown.b ? [data.wave_range] : []];
  const low = Math.min(...ranges.map(([from]) => from)), high = Math.max(...ranges.map(([, to]) => to));
  [bottom, top_] = [low - 0.06 * (high - low), high + 0.06 * (high - low)];
}

function ticks(from, to, wanted) {
  const rough = (to - from) / wanted, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find(factor => factor * power >= rough * 0.999);
  const found = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; k++) found.push(+(k * step).toPrecision(12));
  return found;
}

function draw(efforts, width, height) {
  const numbers = ticks(bottom, top_, height / 60).map(value => [value, String(value).replace("-", "\u2212")]);
  const left = 36 + Math.max(...numbers.map(([, text]) => pen.measureText(text).width)), right = width - 24;
  const ceiling = 30, floor = height - 48;
  const X = x => left + x / end * (right - left), Y = u => floor - (u - bottom) / (top_ - bottom) * (floor - ceiling);
  const stroke = (name, wide, points) => {
    pen.beginPath();
    points.forEach(([x, y], k) => k ? pen.lineTo(x, y) : pen.moveTo(x, y));
    pen.strokeStyle = colour(name); pen.lineWidth = wide; pen.lineJoin = "round"; pen.stroke();
  };
  const say = (text, x, y, align, name) => { pen.fillStyle = colour(name); pen.textAlign = align; pen.fillText(text, x, y); };
  pen.textBaseline = "middle";
  for (const [value, text] of numbers) {
    stroke("grid", 1, [[left, Y(value)], [right, Y(value)]]);
    say(text, left - 8, Y(value), "right", "ink");
  }
  for (const value of ticks(0, end, (right - left) / 90)) {
    stroke("faint", 1, [[X(value), floor], [X(value), floor + 5]]);
    say(String(value), X(value), floor + 16, "center", "ink");
  }
  let taken = -Infinity;
  const names = data.marks.length;
  const last = right - pen.measureText(data.marks[names - 1][1]).width - 12;
  data.marks.forEach(([x, name], k) => {
    stroke("faint", 1, [[X(x), ceiling], [X(x), floor]]);
    const align = k === 0 ? "left" : k === names - 1 ? "right" : "center", wide = pen.measureText(name).width;
    const start = X(x) - (align === "center" ? wide / 2 : 0);
    if (k < names - 1 && (start < taken || (k > 0 && start + wide > last))) return;
    say(name, X(x), 14, align, "ink");
    taken = start + wide + 12;
  });
  stroke("faint", 1, [[left, floor], [right, floor]]);
  say(data.place, (left + right) / 2, height - 12, "center", "ink");
  pen.save();
  pen.translate(12, (ceiling + floor) / 2); pen.rotate(-Math.PI / 2);
  say(data.effort, 0, 0, "center", "ink");
  pen.restore();
  const curve = values => values.map((value, k) => [X(k / (values.length - 1) * end), Y(value)]);
  pen.beginPath();
  [...curve(data.lowest.map(level)), ...curve(data.highest.map(level)).reverse()].forEach(([x, y]) => pen.lineTo(x, y));
  pen.fillStyle = colour("band");
  if (shown.u) pen.fill();
  for (const [kind, name, points] of shown.u ? data.bounds : []) {
    pen.setLineDash({ground: [], rating: [8, 3, 2, 3], vacuum: [2, 3]}[kind]);
    let known = [];
    for (const [x, u] of [...points, [0, null]]) {
      if (u !== null) { known.push([X(x), Y(u)]); continue; }
      if (known.length) stroke(kind, 1.6, known);
      known = [];
    }
    pen.setLineDash([]);
    const last = points.findLast(([, u]) => u !== null);
    if (last) say(name, X(last[0]) - 4, Y(last[1]) + (kind === "vacuum" ? 11 : -9), "right", kind);
  }
  const effort = efforts.map(level), along = data.along[frame].map(wave);
  pen.setLineDash([7, 4]);
  if (shown.a) stroke("along", 1.8, curve(along));
  if (shown.b) stroke("against", 1.8, curve(effort.map((u, k) => u - along[k])));
  pen.setLineDash([]);
  if (shown.u) stroke("line", 2.4, curve(effort));
}

const toggles = document.querySelector(".curves");
toggles.hidden = false;
for (const [key, name, text] of [["u", "line", "u = a/2 + b/2"], ["a", "along", "a/2 \u2192"], ["b", "against", "\u2190 b/2"]]) {
  const each = toggles.appendChild(document.createElement("button"));
  each.textContent = text;
  each.style.borderColor = `var(--${name})`;
  each.setAttribute("aria-pressed", shown[key]);
  keys[key] = () => { shown[key] = !shown[key]; each.setAttribute("aria-pressed", shown[key]); limits(); refresh(); };
  each.addEventListener("click", keys[key]);
}
limits();
