// One pair of axes: series on a canvas, axes in SVG, with hover, zoom, pan and reset by mouse and keyboard.

const charts = new Set();

function css(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// The colours of the printed figures, as light and dark pages have them.
const kInk = {
  "#222222": "--full", "#0072B2": "--pom", "#D55E00": "--lnm", "#009E73": "--second", "#CC79A7": "--pink",
  "#8A5FBF": "--violet", "#777777": "--soft", "#666666": "--soft", "#888888": "--soft",
};

function ink(colour) {
  if (colour.startsWith("--")) return css(colour);
  return kInk[colour] ? css(kInk[colour]) : colour;
}

// Labels come as gnuplot takes them: x_{10} and {/Symbol l}.
function labelParts(label) {
  const greek = {l: "λ", w: "ω", m: "μ", D: "Δ", q: "θ"};
  const text = label.replace(/\{\/Symbol (\w)\}/g, (all, letter) => greek[letter] || letter);
  return text.split(/(_\{[^}]*\})/).filter(part => part !== "")
    .map(part => part.startsWith("_{") ? {text: part.slice(2, -1), sub: true} : {text: part, sub: false});
}

function plain(label) {
  return labelParts(label).map(part => part.text).join("");
}

function writeLabel(text, label) {
  text.text(null);
  let raised = false;
  for (const part of labelParts(label)) {
    text.append("tspan").text(part.text).attr("dy", part.sub && !raised ? "0.3em" : raised && !part.sub ? "-0.3em" : null)
      .attr("font-size", part.sub ? "0.8em" : null);
    raised = part.sub;
  }
}

function number(value) {
  if (!Number.isFinite(value)) return "none";
  const size = Math.abs(value);
  return size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential(3) : String(+value.toPrecision(5));
}

// "displacement x10 = 1.2 m"
function quantity(label, value) {
  const found = /^(.*?)\s*\[([^\]]*)\]$/.exec(plain(label));
  const unit = found && found[2] !== "–" && found[2] !== "1" ? " " + found[2] : "";
  return `${(found ? found[1] : plain(label)) || "value"} = ${number(value)}${unit}`;
}

function span(lists, logarithmic) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const value of list) {
    if (!Number.isFinite(value) || (logarithmic && value <= 0)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return logarithmic ? [0.1, 1] : [0, 1];
  if (logarithmic) return [low / 1.3, high * 1.3];
  const margin = high > low ? 0.04 * (high - low) : 0.05 * Math.abs(high) || 0.5;
  return [low - margin, high + margin];
}

// own: title, x_label, y_label, log_x, log_y, series [{title, look, colour, x, y}], shaded, field; height; pick(x, y) on a
// click; domain {x, y} instead of the data's span.
function chart(parent, own) {
  const margin = {left: 62, right: !own.field ? 12 : own.field.words.length ? 170 : 92, top: 8, bottom: 42};
  const box = d3.select(parent).append("div").attr("class", "chart");
  const heading = box.append("h4").text(own.title || "");
  const tools = box.append("div").attr("class", "tools");
  const stage = box.append("div").attr("class", "stage");
  const canvas = stage.append("canvas"), svg = stage.append("svg");
  const readout = stage.append("div").attr("class", "readout");
  const axisX = svg.append("g"), axisY = svg.append("g");
  const labelX = svg.append("text").attr("text-anchor", "middle"), labelY = svg.append("text").attr("text-anchor", "middle");
  const legend = svg.append("g");
  const dots = svg.append("g");
  const ring = svg.append("circle").attr("r", 5).attr("fill", "none").attr("stroke-width", 2).style("display", "none");
  const pane = svg.append("rect").attr("fill", "transparent");
  const height = own.height || 300;
  let width = 0, placed = [], scaleX, scaleY, shownX, shownY, transform = d3.zoomIdentity, marked = [];

  stage.style("height", height + "px");  // before it is drawn too: the page must not grow under its reader
  svg.attr("tabindex", 0).attr("role", "img");

  const zoom = d3.zoom().scaleExtent([1, 500])
    .filter(() => {
      const event = d3.event;
      if (event.type === "wheel") return event.ctrlKey || event.metaKey || document.activeElement === svg.node();
      return !event.button;
    })
    .on("zoom", () => { transform = d3.event.transform; draw(); });

  function resize() {
    width = Math.max(200, stage.node().parentNode.clientWidth);
    svg.attr("width", width).attr("height", height);
    fit();
  }

  function fit() {
    margin.top = own.series.some(series => series.title) ? 26 : 8;  // the legend stands above
    const inner = [width - margin.left - margin.right, height - margin.top - margin.bottom];
    pane.attr("x", margin.left).attr("y", margin.top).attr("width", inner[0]).attr("height", inner[1]);
    const area = [[margin.left, margin.top], [width - margin.right, height - margin.bottom]];
    zoom.extent(area).translateExtent(area);
    const half = list => list.length > 1 ? Math.abs(list[1] - list[0]) / 2 : 0.5;
    const edges = list => [d3.min(list) - half(list), d3.max(list) + half(list)];
    const domain = own.domain || {};
    const x = domain.x || (own.field ? edges(own.field.x) : span(own.series.map(s => s.x), own.log_x));
    const y = domain.y || (own.field ? edges(own.field.y) : span(own.series.map(s => s.y), own.log_y));
    scaleX = (own.log_x ? d3.scaleLog() : d3.scaleLinear()).domain(x).range([margin.left, width - margin.right]);
    scaleY = (own.log_y ? d3.scaleLog() : d3.scaleLinear()).domain(y).range([height - margin.bottom, margin.top]);
    draw();
  }

  // pixels(longest): what a tick takes whose text has so many letters
  function axis(make, scale, logarithmic, length, pixels, label) {
    const drawn = make(scale).tickSizeOuter(0);
    if (logarithmic) {
      const decades = Math.log10(scale.domain()[1] / scale.domain()[0]), count = Math.max(2, Math.floor(length / pixels(5)));
      return drawn.ticks(decades < 1 ? count : Math.min(count, Math.ceil(decades)), "~g");
    }
    const largest = d3.max(scale.domain(), Math.abs);
    const format = largest < 0.01 || largest >= 1e5 ? value => value === 0 ? "0" : d3.format(".3~e")(value) : value => String(+value.toPrecision(7));
    let count = Math.max(2, Math.floor(length / pixels(4)));
    const longest = d3.max(scale.ticks(count), tick => format(tick).length) || 4;
    count = Math.max(2, Math.floor(length / pixels(longest)));
    const whole = /^(number|mode)\b/.test(label || "");
    return drawn.tickValues(scale.ticks(count).filter(tick => !whole || Number.isInteger(tick))).tickFormat(format);
  }

  function draw() {
    if (!width) return;
    shownX = transform.rescaleX(scaleX);
    shownY = transform.rescaleY(scaleY);
    axisX.attr("transform", `translate(0,${height - margin.bottom})`)
      .call(axis(d3.axisBottom, shownX, own.log_x, width - margin.left - margin.right, letters => 18 + 7 * letters, own.x_label));
    axisY.attr("transform", `translate(${margin.left},0)`)
      .call(axis(d3.axisLeft, shownY, own.log_y, height - margin.top - margin.bottom, () => 42));
    labelX.attr("transform", `translate(${(margin.left + width - margin.right) / 2},${height - 7})`);
    labelY.attr("transform", `translate(14,${(margin.top + height - margin.bottom) / 2}) rotate(-90)`);
    writeLabel(labelX, own.x_label || "");
    writeLabel(labelY, own.y_label || "");
    svg.attr("aria-label", `${own.title || ""}: ${plain(own.y_label || "")} over ${plain(own.x_label || "")}. ` +
      "Plus and minus zoom, arrows move, 0 resets.");
    paint();
    drawLegend();
    place();
  }

  // Points that move over the figure without painting it anew.
  function place() {
    const [left, right] = scaleX.range(), [bottom, top] = scaleY.range();
    const shown = placed.map(point => ({...point, px: shownX(point.x), py: shownY(point.y)}))
      .filter(point => point.px >= left && point.px <= right && point.py >= top && point.py <= bottom);
    const circles = dots.selectAll("circle").data(shown);
    circles.exit().remove();
    circles.enter().append("circle").attr("r", 5).attr("stroke-width", 1.5).merge(circles)
      .attr("cx", point => point.px).attr("cy", point => point.py).attr("fill", point => css(point.colour)).attr("stroke", css("--paper"));
  }

  // Of many decades the whole ones.
  function gridTicks(scale, count) {
    const [low, high] = scale.domain();
    const decades = scale.base && high / low > 30;
    return scale.ticks(count).filter(tick => !decades || Math.abs(Math.log10(tick) % 1) < 1e-9);
  }

  function paint() {
    const ratio = Math.max(2, window.devicePixelRatio || 1), area = canvas.node();
    area.width = width * ratio;
    area.height = height * ratio;
    canvas.style("width", width + "px").style("height", height + "px");
    const pen = area.getContext("2d");
    pen.scale(ratio, ratio);
    const left = margin.left, right = width - margin.right, top = margin.top, bottom = height - margin.bottom;
    pen.strokeStyle = css("--grid");
    pen.lineWidth = 1;
    pen.beginPath();
    if (!own.field) {
      for (const tick of gridTicks(shownX, 8)) { const x = Math.round(shownX(tick)) + 0.5; pen.moveTo(x, top); pen.lineTo(x, bottom); }
      for (const tick of gridTicks(shownY, 6)) { const y = Math.round(shownY(tick)) + 0.5; pen.moveTo(left, y); pen.lineTo(right, y); }
    }
    pen.stroke();
    pen.save();
    pen.beginPath();
    pen.rect(left, top, right - left, bottom - top);
    pen.clip();
    pen.fillStyle = css("--shade");
    for (const [from, to] of own.shaded || []) pen.fillRect(shownX(from), top, shownX(to) - shownX(from), bottom - top);
    if (own.field) paintField(pen, own.field);
    own.series.forEach((series, index) => paintSeries(pen, series, index));
    for (const mark of marked) paintMark(pen, mark, top, bottom);
    pen.restore();
    if (own.field) paintScale(pen, own.field, right + 14, top, bottom);
  }

  function paintSeries(pen, series, index) {
    const {x, y, look} = series, colour = ink(series.colour);
    pen.strokeStyle = pen.fillStyle = colour;
    if (look === "dots") {
      const side = series.side || (x.length > 20000 ? 1.1 : x.length > 500 ? 1.8 : 3.5);
      for (let i = 0; i < x.length; ++i) pen.fillRect(shownX(x[i]) - side / 2, shownY(y[i]) - side / 2, side, side);
      return;
    }
    if (look !== "points") {
      pen.lineWidth = series.width || 1.4;
      pen.setLineDash(look === "dashed" || (look === "marked" && index > 0) ? [6, 4] : []);
      pen.beginPath();
      let pending = true;
      for (let i = 0; i < x.length; ++i) {
        const px = shownX(x[i]), py = shownY(y[i]);
        if (!Number.isFinite(px) || !Number.isFinite(py)) { pending = true; continue; }
        if (pending) pen.moveTo(px, py); else pen.lineTo(px, py);
        pending = false;
      }
      pen.stroke();
      pen.setLineDash([]);
    }
    if (series.error) {
      pen.lineWidth = 1.3;
      pen.beginPath();
      for (let i = 0; i < x.length; ++i) {
        if (!Number.isFinite(series.error[i])) continue;
        pen.moveTo(shownX(x[i]), shownY(y[i] - series.error[i]));
        pen.lineTo(shownX(x[i]), shownY(y[i] + series.error[i]));
      }
      pen.stroke();
    }
    if (look === "line" || look === "dashed") return;
    for (let i = 0; i < x.length; ++i) {
      const px = shownX(x[i]), py = shownY(y[i]);
      if (!Number.isFinite(px) || !Number.isFinite(py)) continue;
      pen.beginPath();  // shapes differ too: colour alone tells nothing to some readers
      if (index % 2) pen.rect(px - 3.5, py - 3.5, 7, 7); else pen.arc(px, py, 3.7, 0, 2 * Math.PI);
      if (index % 2) pen.stroke(); else pen.fill();
    }
  }

  function fieldColour(field, value) {
    if (!Number.isFinite(value)) return css("--panel");
    const share = (value - field.low) / (field.high - field.low || 1);
    return d3.interpolateViridis(Math.min(1, Math.max(0, share)));
  }

  function paintField(pen, field) {
    const step = list => list.length > 1 ? Math.abs(list[1] - list[0]) / 2 : 0.5;
    const dx = step(field.x), dy = step(field.y);
    for (let j = 0; j < field.y.length; ++j) for (let i = 0; i < field.x.length; ++i) {
      const x0 = shownX(field.x[i] - dx), x1 = shownX(field.x[i] + dx);
      const y0 = shownY(field.y[j] + dy), y1 = shownY(field.y[j] - dy);
      pen.fillStyle = fieldColour(field, field.value[j * field.x.length + i]);
      pen.fillRect(x0, y0, x1 - x0 + 0.6, y1 - y0 + 0.6);
    }
  }

  function paintScale(pen, field, x, top, bottom) {
    pen.font = "11px system-ui, Arial, sans-serif";
    const words = field.words.length ? field.words : null, steps = words ? words.length : 60;
    for (let k = 0; k < steps; ++k) {
      const y = bottom - (k + 1) * (bottom - top) / steps;
      pen.fillStyle = fieldColour(field, field.low + (steps > 1 ? k / (steps - 1) : 0) * (field.high - field.low));
      pen.fillRect(x, y, 12, (bottom - top) / steps + 0.5);
    }
    pen.fillStyle = css("--ink");
    pen.textBaseline = "middle";
    const count = words ? steps : 5;
    for (let k = 0; k < count; ++k) {
      const y = words ? bottom - (k + 0.5) * (bottom - top) / steps : bottom - k * (bottom - top) / (count - 1);
      const text = words ? words[k] : number(field.low + k * (field.high - field.low) / (count - 1));
      pen.fillText(text, x + 16, y);
    }
  }

  function paintMark(pen, mark, top, bottom) {
    const x = shownX(mark.x);
    pen.strokeStyle = ink(mark.colour || "--soft");
    pen.lineWidth = 1.5;
    pen.setLineDash([3, 3]);
    pen.beginPath();
    pen.moveTo(x, top);
    pen.lineTo(x, bottom);
    pen.stroke();
    pen.setLineDash([]);
    if (mark.y === undefined) return;
    pen.fillStyle = pen.strokeStyle;
    pen.beginPath();
    pen.arc(x, shownY(mark.y), 5, 0, 2 * Math.PI);
    pen.fill();
  }

  function drawLegend() {
    const named = own.series.filter((series, index) =>
      series.title && own.series.findIndex(other => other.title === series.title) === index);
    legend.selectAll("*").remove();
    let x = width - margin.right - 6;
    for (const series of named.reverse()) {
      const text = legend.append("text").text(series.title).attr("y", margin.top - 9).attr("text-anchor", "end").attr("x", x);
      x -= text.node().getComputedTextLength() + 5;
      const points = series.look === "points" || series.look === "dots";
      legend.append("line").attr("x1", x - (points ? 6 : 18)).attr("x2", x).attr("y1", margin.top - 13).attr("y2", margin.top - 13)
        .attr("stroke", ink(series.colour)).attr("stroke-width", points ? 6 : 2.5)
        .attr("stroke-dasharray", series.look === "dashed" ? "5,3" : null);
      x -= 32;
    }
  }

  function nearest(px, py) {
    let best = null, least = 24 * 24;
    for (const series of own.series) for (let i = 0; i < series.x.length; ++i) {
      const dx = shownX(series.x[i]) - px, dy = shownY(series.y[i]) - py, distance = dx * dx + dy * dy;
      if (distance < least) { least = distance; best = {series, x: series.x[i], y: series.y[i], error: series.error && series.error[i]}; }
    }
    return best;
  }

  function fieldAt(px, py) {
    const closest = (list, value) => d3.scan(list, (a, b) => Math.abs(a - value) - Math.abs(b - value));
    const i = closest(own.field.x, shownX.invert(px)), j = closest(own.field.y, shownY.invert(py));
    return {x: own.field.x[i], y: own.field.y[j], value: own.field.value[j * own.field.x.length + i]};
  }

  function told(px, py) {
    const lines = [];
    let found = nearest(px, py);
    if (found && found.series.title) lines.push(found.series.title);
    if (!found && own.field) {
      found = fieldAt(px, py);
      const word = own.field.words[Math.round(found.value - own.field.low)];
      lines.push(!Number.isFinite(found.value) ? own.field.missing || "no value" : word || quantity(own.field.label, found.value));
    }
    if (!found) return null;
    lines.push(quantity(own.x_label || "x", found.x), quantity(own.y_label || "y", found.y) + (found.error ? ` ± ${number(found.error)}` : ""));
    return {found, lines};
  }

  pane.on("mousemove", () => {
    const [px, py] = d3.mouse(svg.node()), said = told(px, py);
    readout.style("display", said ? "block" : "none");
    ring.style("display", said ? null : "none");
    if (!said) return;
    ring.attr("cx", shownX(said.found.x)).attr("cy", shownY(said.found.y)).attr("stroke", css("--ink"));
    readout.text(null);
    for (const line of said.lines) readout.append("div").text(line);
    const leftwards = px > width / 2;
    readout.style("left", leftwards ? null : px + 14 + "px").style("right", leftwards ? width - px + 14 + "px" : null)
      .style("top", Math.max(0, py - 20) + "px");
  }).on("mouseleave", () => { readout.style("display", "none"); ring.style("display", "none"); })
    .on("click", () => {
      svg.node().focus({preventScroll: true});
      if (!own.pick) return;
      const [px, py] = d3.mouse(svg.node()), found = nearest(px, py);
      own.pick(found ? found.x : shownX.invert(px), found ? found.y : shownY.invert(py));
    });

  const scaled = factor => zoom.scaleBy(svg, factor);
  const reset = () => svg.call(zoom.transform, d3.zoomIdentity);
  svg.call(zoom).on("dblclick.zoom", reset).on("keydown", () => {
    const key = d3.event.key, step = 60 / transform.k;
    const moves = {ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step]};
    if (key === "+" || key === "=") scaled(1.4);
    else if (key === "-") scaled(1 / 1.4);
    else if (key === "0" || key === "Home") reset();
    else if (moves[key]) zoom.translateBy(svg, ...moves[key]);
    else return;
    d3.event.preventDefault();
  });
  for (const [sign, name, act] of [["+", "zoom in", () => scaled(1.6)], ["−", "zoom out", () => scaled(1 / 1.6)],
    ["reset", "show all again", reset]]) {
    tools.append("button").attr("type", "button").text(sign).attr("aria-label", `${name}: ${own.title || own.what || "figure"}`)
      .attr("title", name).on("click", act);
  }

  const made = {
    resize, draw, reset,
    node: box.node(),
    // Other content; the zoom stays unless the axes change.
    set(change) { Object.assign(own, change); if (change.title !== undefined) heading.text(own.title); if (width) fit(); },
    points(points) { placed = points; if (width) place(); },
    mark(marks) { marked = marks; if (width) paint(); },
    pixel(i) { return [shownX(own.series[0].x[i]), shownY(own.series[0].y[i])]; },
    get view() { return {x: shownX.domain(), y: shownY.domain(), k: transform.k}; },
  };
  charts.add(made);
  whenSeen(box.node(), resize);
  return made;
}

// Charts are drawn when they come near the window: a page of fifty opens at once.
const seen = new IntersectionObserver(entries => {
  for (const entry of entries) {
    if (!entry.isIntersecting) continue;
    seen.unobserve(entry.target);
    entry.target.drawFirst();
  }
}, {rootMargin: "400px"});

function whenSeen(node, act) {
  node.drawFirst = () => { node.drawFirst = null; act(); };
  seen.observe(node);
}

function redrawAll() {
  for (const one of charts) if (!one.node.drawFirst) one.resize();
}
