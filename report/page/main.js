// The page from its document: answers first, then what is linked, then every figure and table of every file.

async function documentOf(node) {
  const letters = atob(node.textContent), bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) bytes[i] = letters.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return JSON.parse(await new Response(stream).text());
}

// Lists as report/json.cpp writes them.
function list(own) {
  if (Array.isArray(own)) return own.map(value => value === null ? NaN : value);
  const out = new Float64Array(own.d.length);
  let at = 0;
  own.d.forEach((difference, i) => {
    if (difference === null) { out[i] = NaN; return; }
    at += difference;
    const value = own.low + at * own.step;
    out[i] = own.log ? 10 ** value : value;
  });
  return out;
}

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  redrawAll();
}

function isDark() {
  const own = document.documentElement.dataset.theme;
  return own ? own === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

function section(main, id, title, what) {
  const made = main.append("section").attr("id", id);
  made.append("h2").text(title);
  if (what) made.append("p").attr("class", "soft").text(what);
  return made;
}

function audits(files) {
  return files.filter(file => file.provenance && file.provenance.audit)
    .map(file => ({file: file.name, residual: Math.abs(file.provenance.audit.residual)}));
}

function firstScreen(main, data) {
  const top = main.append("div").attr("class", "top");
  const heading = top.append("div");
  heading.append("h1").text(data.title);
  const kinds = data.files.map(file => file.kind).filter((kind, i, all) => all.indexOf(kind) === i).join(", ");
  heading.append("p").attr("class", "soft").text(`slipmode ${data.version}, commit ${data.commit}: ${kinds}`);
  top.append("button").attr("type", "button").attr("id", "theme").text("Light or dark")
    .on("click", () => setTheme(isDark() ? "light" : "dark"));

  const answers = [...data.answers], kept = audits(data.files);
  if (kept.length) {
    const worst = kept.reduce((a, b) => b.residual > a.residual ? b : a);
    answers.push({question: "Does the energy balance close?", tone: worst.residual < 1e-6 ? "good" : "poor",
      answer: `To ${worst.residual.toExponential(1)} of the energy exchanged, in the worst of the runs audited (${worst.file}).`});
  }
  const cards = main.append("div").attr("class", "answers").selectAll("div").data(answers).enter().append("div")
    .attr("class", own => `answer ${own.tone}`);
  const tones = {good: "✓ good", fair: "○ with care", poor: "✗ poor", plain: ""};
  cards.append("span").attr("class", "tone").text(own => tones[own.tone]);
  cards.append("h3").text(own => own.question);
  cards.append("p").text(own => own.answer);

  if (!data.command) return;
  main.append("h3").text(data.repeats ? "The command that repeats it" : "The command that made it, as far as the file keeps it");
  const line = main.append("div").attr("class", "command");
  line.append("code").text(data.command);
  const copy = line.append("button").attr("type", "button").text("Copy").on("click", async () => {
    const node = copy.node();
    await copyText(data.command);
    said(node, "copied");
  });
}

function decodedPanel(panel) {
  const field = panel.field && {...panel.field, x: list(panel.field.x), y: list(panel.field.y), value: list(panel.field.value)};
  return {...panel, field, series: panel.series.map(series => ({...series, x: list(series.x), y: list(series.y), error: series.error && list(series.error)}))};
}

function takeFigure(file, name) {
  const found = file.figures.find(own => own.name === name);
  file.figures = file.figures.filter(own => own !== found);
  return found;
}

const overModes = [];  // charts over the number of modes, marked by the slider

function figure(parent, own) {
  parent.append("h3").text(own.what);
  const panels = own.drawing.panels, columns = Math.min(own.drawing.columns, panels.length, 4);
  const grid = parent.append("div").attr("class", columns > 2 ? "panels many" : "panels").style("--columns", columns);
  const height = columns === 1 ? (panels.length > 2 ? 220 : 340) : columns === 2 ? 300 : 240;
  const decoded = panels.map(decodedPanel);
  decoded.forEach((panel, i) => {
    const made = chart(grid.node(), {...panel, what: own.what, height, domain: sharedDomain(own.drawing, decoded, i)});
    if (/number of modes/.test(panel.x_label)) overModes.push(made);
  });
}

// One range for the panels that are compared by eye.
function sharedDomain(drawing, panels, i) {
  const columns = drawing.columns;
  const groups = {all: () => true, row: k => Math.floor(k / columns) === Math.floor(i / columns), column: k => k % columns === i % columns};
  const range = (shared, axis) => shared === "none" || panels[i].field ? undefined
    : span(panels.filter((panel, k) => groups[shared](k)).flatMap(panel => panel.series.map(series => series[axis])), panels[i][`log_${axis}`]);
  return {x: range(drawing.shared_x, "x"), y: range(drawing.shared_y, "y")};
}

function provenance(parent, own) {
  const details = parent.append("details");
  details.append("summary").text("Where it came from: command, scene, version, energy audit");
  const rows = [["command", own.command], ["scene", own.scene], ["overrides", own.overrides.join("  ") || "none"],
    ["seed", own.seed], ["slipmode", `${own.version}, commit ${own.commit}, ${own.compiler}`]];
  for (const [name, value] of Object.entries(own.audit || {})) rows.push([`audit: ${name}`, number(value)]);
  const body = details.append("table").append("tbody");
  for (const [name, value] of rows) {
    const row = body.append("tr");
    row.append("td").attr("class", "text").text(name);
    row.append("td").attr("class", "text").text(value);
  }
  details.append("pre").text(own.scene_text);
}

function fileSection(main, file, index) {
  const made = section(main, `file-${index}`, `${file.name}: ${file.meaning}`);
  file.figures.forEach(own => figure(made, own));
  if (file.animation) (file.animation.shapes ? movingModes : movingTrajectory)(made, file.animation);
  if (file.tables.length) made.append("h3").text("Tables");
  const short = file.tables.filter(own => own.rows > 1 && own.rows <= 30).slice(0, 3);
  file.tables.forEach(own => table(made.node(), own, short.includes(own)));
  if (file.provenance) provenance(made, file.provenance);
}

function contents(main, data, motions) {
  const nav = main.append("nav").attr("aria-label", "Contents");
  if (motions) nav.append("a").attr("href", "#motions").text("motions");
  data.files.forEach((file, i) => nav.append("a").attr("href", `#file-${i}`).text(file.name));
}

async function start() {
  const data = await documentOf(document.getElementById("data"));
  const main = d3.select("#report");
  main.select("#waiting").remove();
  firstScreen(main, data);
  await new Promise(done => requestAnimationFrame(() => setTimeout(done)));  // shown before the rest is read
  const motions = await documentOf(document.getElementById("motion-data"));
  contents(main, data, motions);
  // What stands among the motions is not shown twice.
  const place = motions && main.append("div");
  const diagram = motions && motions.speeds.length > 1 && takeFigure(data.files[0], "bifurcation");
  data.files.forEach((file, i) => fileSection(main, file, i));
  if (motions) motionSection(place, motions, diagram);
  const licence = main.append("details");
  licence.append("summary").attr("class", "soft").text("Drawn with D3; its licence");
  licence.append("pre").text(document.getElementById("licence").textContent);
  let before = null;
  addEventListener("resize", redrawAll);
  matchMedia("(prefers-color-scheme: dark)").addListener(redrawAll);
  addEventListener("beforeprint", () => {
    before = document.documentElement.dataset.theme;
    document.documentElement.classList.add("printing");
    for (const one of charts) if (one.node.drawFirst) one.node.drawFirst();
    setTheme("light");
  });
  addEventListener("afterprint", () => {
    document.documentElement.classList.remove("printing");
    delete document.documentElement.dataset.theme;
    if (before) setTheme(before);
    else redrawAll();
  });
  document.documentElement.dataset.ready = "yes";
}

addEventListener("DOMContentLoaded", () => start().catch(error => {
  const where = document.getElementById("waiting") || document.getElementById("report");
  where.textContent = `This page could not be drawn (${error.message}); a browser of 2023 or later is needed.`;
  throw error;
}));
