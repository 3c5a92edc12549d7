// Robustness curves, and tables to print.

function showRobustness() {
  const {curves, plots} = results.robustness;
  byId('robustness').hidden = curves.length === 0;
  fill('robustness-plots', plots.map(({name, svg}) => element('figure', {},
    element('img', {alt: name.replace(/_/g, ' '), ['s' + 'rc']: `data:image/svg+xml,${encodeURIComponent(svg)}`}),
    element('figcaption', {}, citationLine, ' ', copyButton('Copy SVG', () => svg.replace('</svg>', `<desc>${
        citationLine.replace(/&/g, '&amp;').replace(/</g, '&lt;')}</desc></svg>`))))));
  const rows = curves.flatMap((curve) => curve.points.map((point) => ({...curve, ...point})));
  fill('robustness-table', sortableTable('Error and coverage over strength', [
    {title: 'perturbation', value: (row) => row.perturbation},
    {title: 'strength', numeric: true, value: (row) => row.strength, cell: (row) => `${row.strength} ${row.unit}`},
    {title: 'method', value: (row) => row.method},
    {title: 'ATE RMSE', note: 'm', numeric: true, value: (row) => row.ate_rmse_m, cell: (row) => errorText(row.ate_rmse_m)},
    {title: 'coverage', note: '%', numeric: true, value: (row) => row.coverage, cell: (row) => fixed(100 * row.coverage, 1)},
    {title: 'runs that count', numeric: true, value: (row) => row.counted, cell: (row) => `${row.counted} of ${row.runs}`},
  ], rows));
}

function showPaperTables() {
  byId('paper-tables').hidden = results.paper_tables.length === 0;
  fill('paper-table-list', results.paper_tables.map(({caption, latex, markdown}) => element('details', {},
    element('summary', {}, caption),
    element('p', {}, copyButton('Copy LaTeX', () => `${latex}% ${citationLine}\n`), ' ',
            copyButton('Copy Markdown', () => `${markdown}\n${citationLine}\n`)),
    element('pre', {}, latex))));
}
