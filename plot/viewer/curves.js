// The curves of page.html over t or Newton steps: worst distortion, least scaled Jacobian, |c_D|. They follow marks.js.
// A marker is at the frame shown, the pointer reads values, a click goes to the nearest frame.
const svg = (parent, tag, attributes, text = "") => {
  const made = parent.appendChild(document.createElementNS("http://www.w3.org/2000/svg", tag));
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
};
const tick = v => v && (Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3) ? v.toExponential(0) : format(v);
const nearest = (xs, to) => xs.reduce((best, v, k) => Math.abs(v - to) < Math.abs(xs[best] - to) ? k : best, 0);

function chart({title, text, points}) {
  const figure = $("curves").appendChild(document.createElement("figure"));
  const caption = figure.appendChild(document.createElement("figcaption"));
  const name = Object.assign(caption.appendChild(document.createElement("b")), {textContent: title, title: text});
  const value = caption.appendChild(document.createElement("span"));
  const picture = svg(figure, "svg", {});
  const known = points.filter(([, v]) => v !== null), values = known.map(([, v]) => v);
  const positive = values.filter(v => v > 0), least = Math.min(...positive), most = Math.max(...values);
  const isLog = Math.min(...values) >= 0 && most >= 100 * least;
  let [bottom, top] = isLog ? [10 ** Math.floor(Math.log10(least)), 10 ** Math.ceil(Math.log10(most))]
    : [Math.min(...values), most];
  if (isLog) name.textContent += " (log)";
  if (bottom === top) bottom -= 0.1 * Math.abs(bottom) || 1, top += 0.1 * Math.abs(top) || 1;
  const xs = [...points.map(([v]) => v), ...data.curves.frames].filter(v => v !== null);
  const left = Math.min(...xs), right = Math.max(...xs);
  const size = {w: 0, h: 0}, X0 = 52, X1 = 8, Y0 = 16, Y1 = 6;  // the margins, in pixels
  const across = v => X0 + (size.w - X0 - X1) * (right > left ? (v - left) / (right - left) : 0.5);
  const up = v => {
    const s = isLog ? Math.log(Math.max(v, bottom) / bottom) / Math.log(top / bottom) : (v - bottom) / (top - bottom);
    return size.h - Y0 - (size.h - Y0 - Y1) * s;
  };
  const at = v => `${data.curves.x} ${data.curves.x === "t" ? "= " : ""}${format(v)}`;
  let marker, dot;
  const point = (v, under) => {  // the marker there
    const [, y] = known.findLast(([u]) => u === v) ?? [];
    marker.style.visibility = v === null ? "hidden" : "";
    marker.setAttribute("x1", across(v)), marker.setAttribute("x2", across(v));
    dot.setAttribute("cx", across(v)), dot.setAttribute("cy", y === undefined ? -99 : up(y));
    const isHole = points.some(([u, w]) => u === v && w === null);
    value.textContent = y !== undefined ? `${format(y)}${under ? ` at ${at(v)}` : ""}` : isHole ? "inverted" : "";
  };
  const now = () => point(data.curves.frames[frame], false);
  function draw() {
    Object.assign(size, {w: picture.clientWidth, h: picture.clientHeight});
    picture.replaceChildren();
    if (size.w < X0 + X1 || size.h < Y0 + Y1) return;
    const y = size.h - Y0;
    svg(picture, "path", {class: "axis", d: `M${X0} ${Y1}V${y}H${size.w - X1}`});
    for (let v = bottom; isLog && v <= top; v *= 10) svg(picture, "path", {class: "axis", d: `M${X0} ${up(v)}h-3`});
    svg(picture, "text", {x: X0 - 5, y: Y1 + 7, "text-anchor": "end"}, tick(top));
    svg(picture, "text", {x: X0 - 5, y: y + 1, "text-anchor": "end"}, tick(bottom));
    svg(picture, "text", {x: X0, y: size.h - 3}, at(left));
    svg(picture, "text", {x: size.w - X1, y: size.h - 3, "text-anchor": "end"}, format(right));
    const line = points.map(([v, w], k) =>
      w === null ? "" : `${k && points[k - 1][1] !== null ? "L" : "M"}${across(v)} ${up(w)}`).join("");
    svg(picture, "path", {class: "curve", d: line});
    if (known.length <= 60) for (const [v, w] of known) svg(picture, "circle", {cx: across(v), cy: up(w), r: 1.8});
    for (const v of data.curves.failed) svg(picture, "text", {class: "failed", x: across(v), y}, "×");
    marker = svg(picture, "line", {class: "marker", y1: Y1, y2: y});
    dot = svg(picture, "circle", {class: "marker", r: 4});
    now();
  }
  picture.onpointermove = event => {
    const there = left + (event.offsetX - X0) / (size.w - X0 - X1) * (right - left);
    point(known[nearest(known.map(([v]) => v), there)][0], true);
  };
  picture.onpointerleave = now;
  picture.onclick = event => {
    const there = left + (event.offsetX - X0) / (size.w - X0 - X1) * (right - left);
    play(false);
    showFrame(nearest(data.curves.frames, there));
  };
  return {draw, now};
}
const charts = data.curves.list.map(chart);
$("curves").hidden = charts.length === 0;
