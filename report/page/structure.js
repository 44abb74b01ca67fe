// A structure in motion: masses and springs along a line, a beam, or degrees of freedom side by side; contacts coloured
// by what they do, which is also written beside them.

function contactState(mode) {
  if (mode === 0) return {word: "stick", colour: "--stick"};
  if (mode === 5 || mode === 6) return {word: "at the stop", colour: "--stick"};
  if (mode === 3 || mode === 4 || mode > 6) return {word: "gap", colour: "--gap"};
  return {word: "slip", colour: "--slip"};
}

// modes: [time, mode] pairs in time order
function modeAt(modes, time) {
  let found = modes[0][1];
  for (const [from, mode] of modes) { if (from > time) break; found = mode; }
  return found;
}

// frames: one list per point, all at equal steps of time
function shapeAt(frames, place) {
  return frames.map(list => {
    const at = Math.min(Math.max(place, 0), list.length - 1), below = Math.floor(at), above = Math.min(below + 1, list.length - 1);
    return list[below] + (at - below) * (list[above] - list[below]);
  });
}

// Masses move along the line they stand on, beams and degrees of freedom across it.
function alongLine(structure) {
  return structure.kind === "chain" || structure.kind === "masses";
}

// The mean of each point, and pixels for one unit of displacement about it, so that nothing leaves its place.
function layoutOf(structure, frames, width, height) {
  const mean = frames.map(list => d3.mean(list));
  const largest = d3.max(frames, (list, i) => d3.max(list, value => Math.abs(value - mean[i]))) || 1;
  if (!alongLine(structure)) return {mean: structure.kind === "beam" ? frames.map(() => 0) : mean,
    gain: 0.4 * height / (structure.kind === "beam" ? d3.max(frames, list => d3.max(list, Math.abs)) || 1 : largest)};
  const spacing = width / (structure.x.length + 1.5);
  if (structure.x.length === 1) return {mean, gain: 0.4 * spacing / largest};
  let apart = 1e-300;
  for (let i = 1; i < frames.length; ++i) for (let k = 0; k < frames[i].length; ++k)
    apart = Math.max(apart, Math.abs(frames[i][k] - mean[i] - frames[i - 1][k] + mean[i - 1]));
  return {mean, gain: Math.min(0.55 * spacing / apart, 1.1 * spacing / largest)};
}

function drawWall(pen, x, top, bottom, side) {
  pen.strokeStyle = css("--soft");
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x, top);
  pen.lineTo(x, bottom);
  for (let y = top; y <= bottom - 4; y += 8) { pen.moveTo(x, y); pen.lineTo(x + side * 7, y + 7); }
  pen.stroke();
}

function drawSpring(pen, from, to, y) {
  const turns = 5, step = (to - from) / (2 * turns + 2);
  pen.beginPath();
  pen.moveTo(from, y);
  pen.lineTo(from + step, y);
  for (let k = 1; k <= 2 * turns - 1; ++k) pen.lineTo(from + (k + 0.5) * step, y + (k % 2 ? -5 : 5));
  pen.lineTo(to - step, y);
  pen.lineTo(to, y);
  pen.stroke();
}

function drawContactWord(pen, state, x, y) {
  pen.fillStyle = css(state.colour);
  pen.font = "600 12px system-ui, Arial, sans-serif";
  pen.textAlign = "center";
  pen.fillText(state.word, x, y);
  pen.textAlign = "left";
}

// box: left, top, width, height. belt: how far it has moved, in the structure's units; null: there is none.
function drawStructure(pen, box, structure, layout, shape, states, belt) {
  const shift = i => layout.gain * (shape[i] - layout.mean[i]);
  const middle = box.top + box.height / 2, points = structure.x.length;
  if (alongLine(structure)) {
    const spacing = box.width / (points + 1.5), side = Math.min(22, 0.42 * spacing);
    const x = structure.x.map((own, i) => box.left + (i + 1) * spacing + shift(i));
    const touched = new Map(structure.contacts.map((contact, c) => [structure.x.indexOf(contact.x), c]));
    if (structure.fixed[0]) drawWall(pen, box.left, middle - 18, middle + 18, -1);
    if (structure.fixed[1]) drawWall(pen, box.left + (points + 1) * spacing, middle - 18, middle + 18, 1);
    pen.strokeStyle = css("--soft");
    pen.lineWidth = 1.3;
    const ends = [...(structure.fixed[0] ? [box.left + side / 2] : []), ...x,
      ...(structure.fixed[1] ? [box.left + (points + 1) * spacing - side / 2] : [])];
    for (let i = 1; i < ends.length && structure.kind === "chain"; ++i) {
      const wall = structure.fixed[0] && i === 1 ? side / 2 : 0;
      drawSpring(pen, ends[i - 1] + (wall ? -wall : side / 2), ends[i] - side / 2, middle);
    }
    x.forEach((place, i) => {
      const c = touched.get(i), state = c === undefined ? null : states[c];
      if (state && belt !== null) drawBelt(pen, place, middle + side / 2, spacing, layout.gain * belt);
      pen.fillStyle = state ? css(state.colour) : css("--full");
      pen.fillRect(place - side / 2, middle - side / 2, side, side);
      if (state) drawContactWord(pen, state, place, middle - side / 2 - 6);
    });
    return;
  }
  const span = structure.x[points - 1] - structure.x[0] || 1;
  const x = structure.x.map(own => box.left + 20 + (own - structure.x[0]) / span * (box.width - 90));
  pen.strokeStyle = pen.fillStyle = css("--full");
  pen.lineWidth = structure.kind === "beam" ? 4 : 1.2;
  if (structure.kind === "beam") drawWall(pen, x[0], middle - 22, middle + 22, -1);
  pen.strokeStyle = css("--full");
  pen.lineWidth = structure.kind === "beam" ? 4 : 1.2;
  pen.beginPath();
  x.forEach((place, i) => {
    if (structure.kind === "beam") { if (i) pen.lineTo(place, middle - shift(i)); else pen.moveTo(place, middle - shift(i)); return; }
    pen.moveTo(place, middle);
    pen.lineTo(place, middle - shift(i));
  });
  pen.stroke();
  if (structure.kind !== "beam") x.forEach((place, i) => {
    pen.beginPath();
    pen.arc(place, middle - shift(i), 6, 0, 2 * Math.PI);
    pen.fill();
  });
  structure.contacts.forEach((contact, c) => {
    if (contact.x === null || !states[c]) return;
    const i = d3.scan(structure.x, (a, b) => Math.abs(a - contact.x) - Math.abs(b - contact.x));
    pen.fillStyle = css(states[c].colour);
    pen.fillRect(x[i] - 7, middle - shift(i) - 7, 14, 14);
    drawContactWord(pen, states[c], Math.min(x[i], box.left + box.width - 30), middle - shift(i) - 13);
  });
}

function drawBelt(pen, x, y, spacing, moved) {
  const half = 1.6 * spacing;
  pen.strokeStyle = css("--soft");
  pen.lineWidth = 3;
  pen.setLineDash([9, 5]);
  pen.lineDashOffset = -moved % 14;
  pen.beginPath();
  pen.moveTo(x - half, y + 4);
  pen.lineTo(x + half, y + 4);
  pen.stroke();
  pen.setLineDash([]);
}

function structureKey(parent) {
  const key = d3.select(parent).append("div").attr("class", "key");
  for (const [colour, word] of [["--stick", "stick, or at a stop"], ["--slip", "slip"], ["--gap", "gap"]]) {
    const one = key.append("span");
    one.append("i").attr("class", "block").style("background", `var(${colour})`);
    one.append("span").text(word);
  }
}

// A canvas that redraws itself: rows of [{title, draw(pen, box)}]
function stage(parent, rows, rowHeight) {
  const area = d3.select(parent).append("canvas").attr("class", "structure").attr("role", "img")
    .attr("aria-label", "the structure in motion").node();
  const made = {node: parent, resize: paint, draw: paint};
  function paint() {
    const ratio = Math.max(2, window.devicePixelRatio || 1), width = parent.clientWidth, height = rows.length * rowHeight;
    area.width = width * ratio;
    area.height = height * ratio;
    area.style.width = width + "px";
    area.style.height = height + "px";
    const pen = area.getContext("2d");
    pen.scale(ratio, ratio);
    rows.forEach((row, r) => {
      pen.fillStyle = css("--soft");
      pen.font = "12.5px system-ui, Arial, sans-serif";
      pen.fillText(row.title(), 4, r * rowHeight + 14);
      row.draw(pen, {left: 14, top: r * rowHeight + 12, width: width - 28, height: rowHeight - 12});
    });
  }
  area.style.height = rows.length * rowHeight + "px";
  charts.add(made);
  whenSeen(parent, paint);
  return made;
}

// Runs act(seconds since the last frame) while the page is looked at and `node` is in view.
function everyFrame(node, act) {
  let last = null;
  const step = now => {
    const box = node.getBoundingClientRect(), inView = box.bottom > 0 && box.top < innerHeight;
    if (inView && last !== null) act(Math.min(0.1, (now - last) / 1000));
    last = now;
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

const kStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
