// Tables that are sorted by a click, or by the keyboard, on a column's title.

const compareValues = (a, b) =>
    (typeof a === 'number' && typeof b === 'number' ? a - b : String(a).localeCompare(String(b), 'en', {numeric: true}));
const isMissing = (value) => value === null || value === undefined || value === '' || Number.isNaN(value);

const rowsAtFirst = 200;

/// columns: {title, note, value(row), cell(row), numeric, largestFirst}. `value` is what the column is sorted by; rows
/// where there is none stay last. `cell` gives what is shown (the value where it is not given). The first column names
/// the row. A tall table scrolls below its titles.
function sortableTable(caption, columns, rows, {isTall = false, attributesOf = () => ({})} = {}) {
  const body = element('tbody');
  const heads = columns.map((column) => element('th', {scope: 'col', class: column.numeric ? 'number' : null,
                                                       'aria-sort': column.value ? 'none' : null}));
  const makeLine = (row) => element('tr', attributesOf(row), columns.map((column, i) => {
    const content = column.cell ? column.cell(row) : breakable(String(column.value(row) ?? ''));
    return element(i === 0 ? 'th' : 'td', {scope: i === 0 ? 'row' : null, class: column.numeric ? 'number' : null}, content);
  }));
  // Rows are made when they are shown: thousands would delay the page.
  const lines = rows.map((row) => ({row, line: null}));
  let order = lines, limit = rowsAtFirst;
  const more = element('button', {type: 'button', class: 'more', onclick: () => showAll()}, `Show all ${rows.length} rows`);
  const show = () => body.replaceChildren(...order.slice(0, limit).map((each) => (each.line ??= makeLine(each.row))));
  function showAll() {
    limit = rows.length;
    more.remove();
    show();
  }

  function sortBy(place) {
    const column = columns[place];
    const before = heads[place].getAttribute('aria-sort');
    const first = column.largestFirst ? 'descending' : 'ascending';
    const direction = before === 'none' ? first : before === 'ascending' ? 'descending' : 'ascending';
    heads.forEach((head, i) => head.hasAttribute('aria-sort') && head.setAttribute('aria-sort', i === place ? direction : 'none'));
    const sign = direction === 'ascending' ? 1 : -1;
    const sorted = lines.map((each) => ({each, value: column.value(each.row)}));
    sorted.sort((a, b) => isMissing(a.value) - isMissing(b.value) ||
                          (isMissing(a.value) ? 0 : sign * compareValues(a.value, b.value)));
    order = sorted.map(({each}) => each);
    show();
  }

  columns.forEach((column, i) => {
    const title = [...breakable(column.title), column.note ? element('small', {}, column.note) : null];
    heads[i].append(column.value ? element('button', {type: 'button', onclick: () => sortBy(i)},
                                           element('span', {}, title.filter((part) => part))) :
                                   element('span', {class: 'title'}, title.filter((part) => part)));
  });
  show();
  const table = element('table', {}, element('thead', {}, element('tr', {}, heads)), body);
  table.prepend(element('caption', {}, copyButton('Copy', () => {
    showAll();
    return tableText(table);
  }), caption));
  return element('div', {class: isTall ? 'table tall' : 'table', tabindex: '0', role: 'region', 'aria-label': caption},
                 table, rows.length > rowsAtFirst ? more : null);
}
