// What moves in one file: a motion with its force drawn along, or modes.

function playButton(bar, state) {
  const button = bar.append("button").attr("type", "button");
  const tell = () => button.text(state.playing ? "Pause" : "Play").attr("aria-pressed", state.playing);
  button.on("click", () => { state.playing = !state.playing; tell(); });
  tell();
  return tell;
}

function movingTrajectory(parent, own) {
  parent.append("h3").text("the structure in motion");
  const q = list(own.q), force = list(own.force), shape = own.shape.map(list), end = own.interval * (q.length - 1);
  const state = {time: 0, playing: false};
  const bar = parent.append("div").attr("class", "bar controls");
  const tell = playButton(bar, state);
  const label = bar.append("label");
  label.append("span").text("time");
  const slider = label.append("input").attr("type", "range").attr("min", 0).attr("max", 1000).attr("class", "scrub")
    .on("input", function () { state.playing = false; tell(); state.time = this.value / 1000 * end; move(); });
  const output = label.append("output");
  const moving = parent.append("div").attr("class", "moving").node();
  structureKey(moving);
  const scene = stage(moving, [{
    title: () => "",
    draw: (pen, box) => drawStructure(pen, box, own.structure, layoutOf(own.structure, shape, box.width, box.height),
      shapeAt(shape, state.time / own.interval), own.modes.map(modes => contactState(modeAt(modes, state.time))), null),
  }], alongLine(own.structure) ? 96 : 220);
  const loop = chart(parent.append("div").node(), {title: "Contact force against displacement", x_label: own.labels.q,
    y_label: own.labels.force, height: 300, series: [{title: "", look: "line", colour: "#222222", x: q, y: force}]});

  function move() {
    slider.property("value", Math.round(1000 * state.time / end));
    output.text(number(+(own.start + state.time).toPrecision(6)));
    const i = Math.min(q.length - 1, Math.round(state.time / own.interval));
    loop.points([{x: q[i], y: force[i], colour: "--lnm"}]);
    if (!moving.drawFirst) scene.draw();
  }
  everyFrame(moving, seconds => {
    if (!state.playing) return;
    state.time = (state.time + seconds * end / 12) % end;
    move();
  });
  move();
}

function movingModes(parent, own) {
  parent.append("h3").text("modes in motion");
  const shapes = own.shapes.map(one => ({title: one.title, values: list(one.shape)}));
  const state = {mode: 0, phase: 0.25, playing: false};
  const bar = parent.append("div").attr("class", "bar controls");
  playButton(bar, state);
  const label = bar.append("label");
  label.append("span").text("mode");
  label.append("input").attr("type", "range").attr("min", 0).attr("max", shapes.length - 1).attr("value", 0)
    .attr("class", "mode").on("input", function () { state.mode = +this.value; scene.draw(); });
  const moving = parent.append("div").attr("class", "moving").node();
  const scene = stage(moving, [{
    title: () => shapes[state.mode].title,
    draw: (pen, box) => {
      const values = [...shapes[state.mode].values], share = Math.sin(2 * Math.PI * state.phase);
      const layout = layoutOf(own.structure, values.map(value => [-value, 0, value]), box.width, box.height);
      drawStructure(pen, box, own.structure, layout, values.map(value => share * value), [], null);
    },
  }], alongLine(own.structure) ? 96 : 200);
  everyFrame(moving, seconds => {
    if (!state.playing) return;
    state.phase = (state.phase + seconds / 2.5) % 1;
    if (!moving.drawFirst) scene.draw();
  });
}
