const top_ = data.height + 1.1;

function draw(now, width, height) {
  const ink = colour("ink");
  const size = Math.min(width / (2 * data.width + 2), height / (top_ + 1.4));
  const X = x => width / 2 + size * x, Y = y => height - size * (y + 1.4);
  pen.lineCap = pen.lineJoin = "round";
  const stroke = (colour, wide, points) => {
    pen.beginPath();
    points.forEach(([x, y], k) => k ? pen.lineTo(X(x), Y(y)) : pen.moveTo(X(x), Y(y)));
    pen.strokeStyle = colour; pen.lineWidth = wide; pen.stroke();
  };
  const wheels = [[-data.width, 0, data.radii[0]], [0, now.y, data.pulley], [data.width, 0, data.radii[1]]];
  wheels.forEach(([x, y, r], k) => {
    pen.beginPath(); pen.arc(X(x), Y(y), size * r, 0, 7); pen.strokeStyle = ink; pen.lineWidth = 2; pen.stroke();
    for (const a of [now.turns[k], now.turns[k] + Math.PI / 2])
      stroke(ink, 1.5, [[x - r * Math.cos(a), y + r * Math.sin(a)], [x + r * Math.cos(a), y - r * Math.sin(a)]]);
  });
  for (const [x1, y1, x2, y2] of now.belt) stroke(now.colour, 5, [[x1, y1], [x2, y2]]);
  const [from, to] = now.belt.map(([, , x, y]) => Math.atan2(now.y - y, x));
  pen.beginPath(); pen.arc(X(0), Y(now.y), size * data.pulley, from, to);
  pen.strokeStyle = now.colour; pen.lineWidth = 5; pen.stroke();
  const end = top_ - 0.1, coils = [[0, now.y]];
  for (let k = 1; k < 12; k++) coils.push([k % 2 ? 0.12 : -0.12, now.y + (end - now.y) * k / 12]);
  stroke(ink, 1.5, [...coils, [0, end]]);
  stroke(ink, 3, [[-0.5, end], [0.5, end]]);
  pen.textAlign = "center"; pen.fillStyle = ink;
  pen.fillText("spool 1", X(-data.width), Y(-data.radii[0] - 0.3));
  pen.fillText("spool 2", X(data.width), Y(-data.radii[1] - 0.3));
  pen.fillText(`tension ${now.tension} N    belt ${now.speed} m/s    x_k ${now.x_k} m`,
    width / 2, height - 8);
}
