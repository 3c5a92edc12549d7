// Errors by sequence and variant, improvements over the baseline, published figures, and the runs one by one.

const spreadText = (spread) =>
    (spread.count > 1 && spread.least < spread.most ? `${errorText(spread.least)} – ${errorText(spread.most)}` : null);

function errorCell(cell, quantity, statistic, isBest) {
  if (!cell) return '';
  const spread = cell.errors[quantity][statistic];
  const failed = cell.runs.length - cell.counted;
  const parts = [];
  if (isNumber(spread.median)) parts.push(element(isBest ? 'b' : 'span', {}, errorText(spread.median)));
  const range = spreadText(spread);
  if (range) parts.push(element('small', {}, range));
  if (failed > 0) {
    const marks = cell.runs.length === 1 ? outcomeMarks(results.runs[cell.runs[0]]) :
                                           [element('span', {class: 'mark bad'}, `${failed} of ${cell.runs.length} failed`)];
    parts.push(element('div', {class: 'marks'}, marks));
  }
  if (cell.coverage.least < 1)
    parts.push(element('small', {class: cell.coverage.least < results.minimum_coverage ? 'low' : null},
                       `${percent(cell.coverage.least)} of frames`));
  return parts;
}

function showErrors(quantity, statistic) {
  const {name, unit} = quantities[quantity];
  const medianOf = (variant, sequence) => cellOf(variant, sequence)?.errors[quantity][statistic].median;
  const isCovered = (variant, sequence) => cellOf(variant, sequence)?.coverage.least >= results.minimum_coverage;
  const sequences = results.sequences.map((_, i) => i);
  const bestOf = sequences.map((sequence) => {
    // An error over the easy part of a sequence is no least error.
    const values = results.variants.map((_, variant) => (isCovered(variant, sequence) ? medianOf(variant, sequence) : null)).filter(isNumber);
    return values.length > 1 ? Math.min(...values) : null;
  });
  const columns = [{title: 'sequence', value: (s) => sequenceName(s)}];
  results.variants.forEach((variant, v) => columns.push({
    title: variant.name, numeric: true, value: (s) => medianOf(v, s),
    cell: (s) => errorCell(cellOf(v, s), quantity, statistic, isCovered(v, s) && medianOf(v, s) === bestOf[s]),
  }));
  fill('error-table', sortableTable(`${name}, ${statistics[statistic]} [${unit}], by sequence and variant`, columns, sequences));
}

function showImprovements(quantity) {
  byId('improvements').hidden = results.improvements.length === 0;
  const columns = [
    {title: 'sequence', value: (i) => sequenceName(i.sequence)},
    {title: 'variant', value: (i) => variantName(i.variant),
     cell: (i) => [variantName(i.variant), element('small', {}, `against ${variantName(i.baseline)}`)]},
  ];
  for (const [key, label] of Object.entries(statistics)) {
    columns.push({
      title: label, note: '%', numeric: true, largestFirst: true, value: (i) => i[quantity].percent[key],
      cell: (i) => [
        element('span', {class: i[quantity].percent[key] < 0 ? 'worse' : null}, fixed(i[quantity].percent[key], 2)),
        element('small', {}, `${errorText(i[quantity].before[key])} → ${errorText(i[quantity].after[key])}`),
      ],
    });
  }
  fill('improvement-table', sortableTable(`Improvements: ${quantities[quantity].name} [${quantities[quantity].unit}]`,
                                          columns, results.improvements, {isTall: true}));
}

/// What makes published figures incomparable with ours.
const markOf = ({input, alignment}) => {
  const parts = [input === 'monocular' ? input : null, alignment === 'SE(3)' ? null : alignment].filter((part) => part);
  return parts.length ? ` (${parts.join(', ')})` : '';
};

function showPublished() {
  const rows = [
    ...results.variants.map((variant, v) => ({
      system: variant.name, here: true, source: 'this report', protocol: 'SE(3), median over runs',
      valueOf: (s) => cellOf(v, s)?.errors.ate_m.rmse.median,
    })),
    ...results.published.map((published) => ({
      system: published.system, here: false, mark: markOf(published), source: published.citation, protocol: published.protocol,
      valueOf: (s) => published.ate_rmse_m[sequenceName(s)],
    })),
  ];
  byId('published').hidden = results.published.length === 0;
  const withFigures = results.sequences.map((_, s) => s)
      .filter((s) => results.published.some((published) => isNumber(published.ate_rmse_m[sequenceName(s)])));
  fill('published-table', sortableTable('Published ATE RMSE [m], and ours', [
    {title: 'system', value: (row) => row.system, cell: (row) => (row.here ? element('b', {}, breakable(`${row.system} (here)`)) : row.system + row.mark)},
    ...withFigures.map((s) => ({
      title: sequenceName(s), numeric: true, value: (row) => row.valueOf(s),
      // What others printed is shown with the digits that they printed.
      cell: (row) => (!isNumber(row.valueOf(s)) ? '' : row.here ? errorText(row.valueOf(s)) : String(row.valueOf(s))),
    })),
    {title: 'source', value: (row) => row.source},
    {title: 'protocol', value: (row) => row.protocol},
  ], rows, {attributesOf: (row) => ({class: row.here ? 'here' : null,
                               'data-citation': row.here ? null : `${row.system}${row.mark}: ${row.source}; ${row.protocol}`})}));
}

function showRuns(onlyTrouble, showTrajectory) {
  const link = (run, file, text) =>
      element('a', {href: `${run.folder.split('/').map(encodeURIComponent).join('/')}/${file}`}, text);
  const errorColumn = (key, title) => ({
    title, note: `RMSE, ${quantities[key].unit}`, numeric: true,
    value: (run) => run.result?.errors?.[key].rmse,
    cell: (run) => (run.result?.errors ? element(run.counts ? 'span' : 'i', {}, errorText(run.result.errors[key].rmse)) : '–'),
  });
  fill('run-table', sortableTable('Every run; errors in italics enter no table', [
    {title: 'variant', value: (run) => variantName(run.variant)},
    {title: 'sequence', value: (run) => sequenceName(run.sequence)},
    {title: 'chance', value: (run) => 1e3 * run.seed + run.repeat, cell: (run) => chanceOf(run)},
    {title: 'outcome', value: (run) => run.outcome, cell: outcomeMarks},
    {title: 'coverage', note: '%', numeric: true, value: (run) => run.result?.coverage, cell: (run) => fixed(100 * run.result?.coverage, 1)},
    errorColumn('ate_m', 'ATE'), errorColumn('rpe_translation_m', 'RPE trans.'), errorColumn('rpe_rotation_deg', 'RPE rot.'),
    {title: 'time', note: 's', numeric: true, value: (run) => run.cost?.wall_s, cell: (run) => fixed(run.cost?.wall_s, 1)},
    {title: 'memory', note: 'MB', numeric: true, value: (run) => run.cost?.peak_memory_bytes,
     cell: (run) => fixed(run.cost?.peak_memory_bytes / 1e6, 0)},
    {title: 'look at', cell: (run) => (run.result === null ? '' : element('div', {class: 'look'}, [
      run.tracks ? element('button', {type: 'button', class: 'plain', onclick: () => showTrajectory(run)}, 'trajectory') : null,
      link(run, run.configuration, 'configuration'), run.report ? link(run, 'report.html', 'report') : null,
      link(run, 'log.txt', 'log'), link(run, '', 'folder'),
    ]))},
  ], results.runs.filter((run) => !onlyTrouble || hasTrouble(run)), 
      {isTall: true, attributesOf: (run) => ({class: run.counts ? null : 'failed'})}));
}
