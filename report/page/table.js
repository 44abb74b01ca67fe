// Tables: sorted by a click on a column, copied as CSV.

function cellText(value) {
  return value === null ? "" : typeof value === "number" ? number(value) : value;
}

function csvOf(columns, order) {
  const cell = value => {
    const text = value === null ? "" : String(value);
    return /[",\n\r]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
  };
  const lines = [columns.map(column => cell(column.unit && column.unit !== "1" ? `${column.name} [${column.unit}]` : column.name))];
  for (const i of order) lines.push(columns.map(column => cell(column.values[i])));
  return lines.map(line => line.join(",")).join("\r\n") + "\r\n";
}

async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch (refused) {  // where a page of a file may not use it
    const area = document.body.appendChild(document.createElement("textarea"));
    area.value = text;
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}

function said(button, text) {
  const before = button.dataset.text || button.textContent;
  button.dataset.text = before;
  button.textContent = text;
  setTimeout(() => { button.textContent = before; }, 1500);
}

function table(parent, own, open) {
  const details = d3.select(parent).append("details").property("open", open);
  const what = own.what || own.name;
  details.append("summary").text(`${what}: ${own.rows} row${own.rows === 1 ? "" : "s"} (${own.name})`);
  if (own.left_out) {
    details.append("p").attr("class", "soft")
      .text("Too long for a page; the file has it all, under the name in brackets.");
    return;
  }
  let order = d3.range(own.rows), sorted = null;
  const bar = details.append("div").attr("class", "bar");
  const copy = bar.append("button").attr("type", "button").text("Copy as CSV").on("click", async () => {
    const node = copy.node();
    await copyText(csvOf(own.columns, order));
    said(node, `${own.rows} rows copied`);
  });
  const frame = details.append("div").attr("class", "table").attr("tabindex", 0).append("table");
  const isText = column => column.values.some(value => typeof value === "string");
  const heads = frame.append("thead").append("tr").selectAll("th").data(own.columns).enter().append("th")
    .attr("scope", "col").attr("class", column => isText(column) ? "text" : null).attr("title", column => column.meaning);
  heads.append("button").attr("type", "button").text(column => column.name).on("click", sort)
    .append("small").text(column => column.unit && column.unit !== "1" ? column.unit : "\u00a0");
  const body = frame.append("tbody");

  function sort(column) {
    const down = sorted && sorted.column === column && !sorted.down;
    sorted = {column, down};
    const value = i => column.values[i];
    order = d3.range(own.rows).sort((a, b) => {
      if (value(a) === null || value(b) === null) return (value(a) === null) - (value(b) === null) || a - b;
      return (down ? -1 : 1) * d3.ascending(value(a), value(b)) || a - b;
    });
    heads.attr("aria-sort", other => other === column ? (down ? "descending" : "ascending") : null);
    fill();
  }

  function fill() {
    body.selectAll("tr").remove();
    body.selectAll("tr").data(order).enter().append("tr").selectAll("td")
      .data(i => own.columns.map(column => ({column, value: column.values[i]}))).enter().append("td")
      .attr("class", cell => isTextCell(cell) ? "text" : null).attr("title", cell => isTextCell(cell) ? cell.value : null)
      .text(cell => cellText(cell.value));
  }
  const isTextCell = cell => typeof cell.value === "string";

  // Long ones are filled when they are opened.
  if (details.property("open")) fill();
  else details.on("toggle", () => { if (!body.node().firstChild) fill(); });
}
