// The motions behind a diagram over speed or frequency: a value and a number of modes are chosen, all figures follow.

function decodedMotion(own) {
  if (!own || own.time) return own;
  for (const name of ["q", "v", "force", "hz", "amplitude"]) own[name] = list(own[name]);
  own.shape = own.shape.map(list);
  own.time = own.q.map((value, i) => i * own.interval);
  return own;
}

function stickStretches(own) {
  const out = [], modes = own.modes[0], end = own.time[own.time.length - 1];
  modes.forEach(([from, mode], i) => {
    if (mode === 0) out.push([from, i + 1 < modes.length ? modes[i + 1][0] : end]);
  });
  return out;
}

function motionSection(main, own, diagram) {
  const label = own.labels, speeds = own.speeds;
  const nearest = x => d3.scan(speeds, (a, b) => Math.abs(a - x) - Math.abs(b - x));
  const state = {speed: nearest(own.own_speed), model: Math.max(1, own.models.findIndex(model => model.modes === own.chosen)),
    time: 0, playing: !kStill};
  const many = speeds.length > 1;
  const made = section(main, "motions", many ? `Motions at a ${own.word}` : "Motion, in full and reduced",
    (many ? `Click a ${own.word} in the diagram, or use the sliders. Motions are kept at ${speeds.length} of them: the nearest is ` +
      `shown. ` : "The slider changes the reduced model. ") +
    `Each model settled ${own.settled}; what is shown begins ${own.begins} and lasts ${own.periods} of ${own.counted}, spectra are ` +
    `of ${own.spectrum_periods}.`);

  const bar = made.append("div").attr("class", "bar controls");
  const slider = (id, text, most, act) => {
    const one = bar.append("label");
    one.append("span").text(text);
    const input = one.append("input").attr("type", "range").attr("id", id).attr("min", 0).attr("max", most).attr("step", 1)
      .on("input", function () { act(+this.value); });
    return {input, output: one.append("output")};
  };
  const slot = k => speeds[0] > speeds[speeds.length - 1] ? speeds.length - 1 - k : k;  // larger values to the right
  const bySpeed = slider("speed", plain(label.speed).replace(/\s*\[.*/, ""), speeds.length - 1, k => { state.speed = slot(k); choose(); });
  bySpeed.input.property("disabled", !many);
  const byModes = slider("modes", `number of ${own.vectors}`, own.models.length - 2, k => { state.model = k + 1; choose(); });
  const play = bar.append("button").attr("type", "button").attr("id", "play").on("click", () => { state.playing = !state.playing; tellPlaying(); });
  const byTime = slider("time", "time", 1000, k => { state.playing = false; tellPlaying(); state.time = k / 1000 * end(); move(); });
  const told = made.append("p").attr("id", "told").attr("aria-live", "polite");

  // The same axes for both models: what is compared stands one above the other.
  const panels = diagram ? diagram.drawing.panels.map(decodedPanel) : [];
  const slips = own.models.map(model => ({x: list(model.slips.x), y: list(model.slips.y)}));
  const domain = {x: span([speeds, ...panels.map(panel => panel.series[0].x), slips[0].x]),
    y: span([...panels.map(panel => panel.series[0].y), ...slips.map(one => one.y)])};
  const pick = x => { state.speed = nearest(x); choose(); };
  const diagrams = (many ? [0, 1] : []).map(k => chart(made.append("div").attr("class", k ? "reduced-diagram" : "full-diagram").node(),
    {...slipPanel(k ? state.model : 0), height: 260, domain, pick, x_label: label.speed, y_label: label.slip}));

  function slipPanel(m) {
    const model = own.models[m], swept = panels[m === 0 ? 0 : 1];
    const colour = m === 0 ? "#222222" : "#0072B2";
    if (swept && (m === 0 || model.modes === own.chosen)) return {title: swept.title, series: swept.series};
    return {title: `${model.title}, computed for this page at ${own.all_speeds} values`,
      series: [{title: "", look: "dots", colour, side: 2.6, ...slips[m]}]};
  }

  const moving = made.append("div").attr("class", "moving").node();
  structureKey(moving);
  const rows = [0, 1].map(k => ({
    title: () => own.models[k ? state.model : 0].title,
    draw: (pen, box) => {
      const both = current(), motion = both[k];
      if (!motion) return;
      // One scale for both, about the first one's mean.
      const layouts = both.filter(one => one).map(one => layoutOf(own.structure, one.shape, box.width, box.height));
      const layout = {mean: layouts[0].mean, gain: d3.min(layouts, one => one.gain)};
      const shape = shapeAt(motion.shape, state.time / (motion.interval * own.samples_per_shape));
      drawStructure(pen, box, own.structure, layout, shape, motion.modes.map(modes => contactState(modeAt(modes, state.time))),
        speeds[state.speed] * state.time);
    },
  }));
  const scene = stage(moving, rows, 96);

  const grid = made.append("div").attr("class", "panels").style("--columns", 2).node();
  const empty = {series: [], height: 300};
  const history = chart(grid, {...empty, title: "History: stick of the full model is shaded", x_label: label.time, y_label: label.q});
  const portrait = chart(grid, {...empty, title: "Phase portrait", x_label: label.q, y_label: label.v});
  const loop = chart(grid, {...empty, title: "Contact force against displacement", x_label: label.q, y_label: label.force});
  const spectrum = chart(grid, {...empty, title: "Spectrum of the velocity", x_label: label.hz, y_label: label.amplitude, log_y: true});

  function current() {
    return [0, state.model].map(m => decodedMotion(own.models[m].motions[state.speed]));
  }
  function end() {
    const motion = current().find(one => one);
    return motion ? motion.time[motion.time.length - 1] : 1;
  }
  function tellPlaying() {
    play.text(state.playing ? "Pause" : "Play").attr("aria-pressed", state.playing);
  }

  function choose() {
    const both = current(), models = [own.models[0], own.models[state.model]], speed = speeds[state.speed];
    state.time = Math.min(state.time, end());
    bySpeed.input.property("value", slot(state.speed));
    bySpeed.output.text(number(speed));
    byModes.input.property("value", state.model - 1);
    byModes.output.text(models[1].modes);
    told.text(`${quantity(label.speed, speed)}: ` + models.map(model => `${model.title}: ${model.said[state.speed]}`).join("; ") + ".");
    diagrams.forEach((one, k) => {
      if (k) one.set(slipPanel(state.model));
      one.mark([{x: speed, colour: "--second"}]);
    });
    for (const one of overModes) one.mark([{x: models[1].modes, colour: "--second"}]);
    const series = (x, y) => both.map((motion, k) => motion && {title: models[k].title, look: "line",
      colour: k ? "#0072B2" : "#222222", width: k ? 1.1 : 1.7, x: motion[x], y: motion[y]}).filter(one => one);
    history.set({series: series("time", "q"), shaded: both[0] ? stickStretches(both[0]) : []});
    portrait.set({series: series("q", "v")});
    loop.set({series: series("q", "force")});
    spectrum.set({series: series("hz", "amplitude")});
    move();
  }

  function move() {
    byTime.input.property("value", Math.round(1000 * state.time / end()));
    byTime.output.text(number(+state.time.toPrecision(4)));
    const at = both => both.map((motion, k) => {
      if (!motion) return null;
      const i = Math.min(motion.time.length - 1, Math.round(state.time / motion.interval));
      return {motion, i, colour: k ? "--pom" : "--full"};
    }).filter(one => one);
    const now = at(current());
    const points = (x, y) => now.map(({motion, i, colour}) => ({x: motion[x][i], y: motion[y][i], colour}));
    history.points(points("time", "q"));
    portrait.points(points("q", "v"));
    loop.points(points("q", "force"));
    if (!moving.drawFirst) scene.draw();
  }

  everyFrame(made.node(), seconds => {
    if (!state.playing) return;
    state.time = (state.time + seconds * end() / (4 * own.periods)) % end();
    move();
  });
  tellPlaying();
  choose();
}
