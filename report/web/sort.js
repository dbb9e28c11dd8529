// Tables whose rows are sorted by the column on whose head one clicks; what is missing comes last.
"use strict";

function sortKey(row, column) {
  const cell = row.cells[column];
  const number = cell.querySelector("data");
  if (number !== null) return Number(number.value);
  const text = cell.textContent.trim();
  return text === "" || text === "—" ? null : text;
}

function compareKeys(one, two, upward) {
  if (one === null || two === null) return (one === null) - (two === null);
  const order = typeof one === "number" && typeof two === "number"
    ? one - two
    : String(one).localeCompare(String(two), undefined, { numeric: true });
  return upward ? order : -order;
}

function sortBy(table, column) {
  const head = table.tHead.rows[0].cells[column];
  const upward = head.getAttribute("aria-sort") !== "ascending";
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", upward ? "ascending" : "descending");
  const rows = [...table.tBodies[0].rows];
  rows.sort((a, b) => compareKeys(sortKey(a, column), sortKey(b, column), upward));
  table.tBodies[0].append(...rows);
}

for (const table of document.querySelectorAll("table.sortable")) {
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const button = document.createElement("button");
    button.append(...head.childNodes);
    button.addEventListener("click", () => sortBy(table, column));
    head.append(button);
  });
}
