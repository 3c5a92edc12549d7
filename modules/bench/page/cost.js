// Time and memory: by variant, and by stage of our own program.

const isDecoding = (stage) => stage === 'decode';

/// Variants with what their runs cost: medians over cells, the most of memory.
function variantCosts() {
  return results.variants.map((variant, v) => {
    const cells = results.cells.filter((cell) => cell.variant === v);
    const middle = (key) => median(cells.map((cell) => cell.cost[key].median));
    return {
      name: variant.name, tracking: 1e3 * middle('tracking_s'), perFrame: 1e3 * middle('wall_per_frame_s'), processor: middle('processor_s'),
      memory: Math.max(...cells.map((cell) => cell.cost.peak_memory_bytes.most).filter(isNumber), -Infinity) / 1e6,
      ratio: middle('processor_ratio'),
      others: Math.max(...cells.map((cell) => cell.cost.other_processors.most).filter(isNumber), -Infinity),
      alone: cells.every((cell) => cell.cost.alone), isThere: cells.some((cell) => cell.counted > 0),
    };
  }).filter((row) => row.isThere);
}

/// For every variant of ours: [stage, milliseconds per frame], and all stages in the order in which they run.
function stageCosts() {
  const stages = [];
  const rows = [];
  results.variants.forEach((variant, v) => {
    const runs = results.runs.filter((run) => run.variant === v && run.counts && run.cost?.stages.length && run.result.frames > 0);
    if (runs.length === 0) return;
    const times = new Map();
    for (const run of runs)
      for (const {stage, total_s} of run.cost.stages) {
        if (!stages.includes(stage)) stages.push(stage);
        times.set(stage, [...(times.get(stage) ?? []), 1e3 * total_s / run.result.frames]);
      }
    rows.push({name: variant.name, times: new Map([...times].map(([stage, values]) => [stage, median(values)]))});
  });
  return {stages, rows};
}

function showStages(withDecoding) {
  const {stages, rows} = stageCosts();
  const shown = stages.filter((stage) => withDecoding || !isDecoding(stage));
  const totalOf = (row) => shown.reduce((sum, stage) => sum + (row.times.get(stage) ?? 0), 0);
  const longest = Math.max(...rows.map(totalOf), 0) || 1;
  // The dearest stages get a colour of their own, the others share one.
  const dearest = [...shown].sort((a, b) => Math.max(...rows.map((r) => r.times.get(b) ?? 0)) - Math.max(...rows.map((r) => r.times.get(a) ?? 0)))
                      .slice(0, coloursInScale);
  const named = shown.filter((stage) => dearest.includes(stage));
  const parts = (row) => [
    ...named.map((stage, i) => ({stage, time: row.times.get(stage) ?? 0, colour: `var(--series-${i})`})),
    {stage: 'everything else', colour: 'var(--truth)',
     time: shown.filter((stage) => !named.includes(stage)).reduce((sum, stage) => sum + (row.times.get(stage) ?? 0), 0)},
  ];
  fill('stage-bars', rows.map((row) => element('div', {class: 'bar-row'},
    element('span', {class: 'bar-name'}, row.name),
    element('span', {class: 'stack', role: 'img', 'aria-label': `${row.name}: ${parts(row).map(({stage, time}) => `${stage} ${fixed(time, 2)} ms`).join(', ')}`},
            parts(row).filter(({time}) => time > 0).map(({stage, time, colour}) =>
                element('span', {style: `width: ${100 * time / longest}%; background: ${colour}`, title: `${stage}: ${fixed(time, 2)} ms a frame`}))),
    element('span', {class: 'bar-total'}, `${fixed(totalOf(row), 1)} ms`))),
    element('p', {class: 'key'}, rows.length === 0 ? 'No run of ours has finished.' :
            parts(rows[0]).map(({stage, colour}) => element('span', {}, element('i', {style: `background: ${colour}`}), stage))));
  fill('stage-table', sortableTable('Milliseconds per frame by stage', [
    {title: 'stage', value: (stage) => stages.indexOf(stage), cell: (stage) => stage},
    ...rows.map((row) => ({title: row.name, note: 'ms', numeric: true, largestFirst: true, value: (stage) => row.times.get(stage),
                           cell: (stage) => fixed(row.times.get(stage), 3)})),
  ], stages));
}

function showCost() {
  const runs = results.runs.filter((run) => run.cost);
  const all = (key) => [...new Set(runs.map((run) => run.cost[key]).filter((text) => text))].join('; ');
  const remarks = [];
  if (all('machine')) remarks.push(`Machine: ${all('machine')}. `);
  if (all('version')) remarks.push(`Holdfast ${all('version')}. `);
  const beside = runs.filter((run) => !run.cost.alone), withOthers = runs.filter((run) => run.cost.alone && run.cost.other_processors > 0.1);
  const machines = new Set(runs.map((run) => run.cost.machine));
  const warn = (text) => remarks.push(element('b', {}, text), ' ');
  if (machines.size > 1) warn(`Runs were executed on ${machines.size} kinds of machine: times are compared within one only (cost.md).`);
  if (beside.length > 0) warn(`${counted(beside.length, 'run')} of ${runs.length} had other runs of this bench beside them, which disturbs times.`);
  if (withOthers.length > 0)
    warn(`${counted(withOthers.length, 'run')} of ${runs.length} had other programs beside them, which kept up to ${
        fixed(Math.max(...withOthers.map((run) => run.cost.other_processors)), 2)} processors busy: times are disturbed.`);
  if (beside.length + withOthers.length === 0 && runs.length > 0)
    remarks.push(runs.some((run) => isNumber(run.cost.other_processors)) ?
        'Every run was alone: no other run of this bench, and hardly any other program.' :
        'No other run of this bench was beside a run; what other programs did is not known.');
  fill('cost-remark', remarks);
  fill('cost-table', sortableTable('Time and memory by variant; medians over runs and sequences', [
    {title: 'variant', value: (row) => row.name},
    {title: 'tracking', note: 'ms a frame', numeric: true, value: (row) => row.tracking, cell: (row) => fixed(row.tracking, 2)},
    {title: 'whole process', note: 'ms a frame', numeric: true, value: (row) => row.perFrame, cell: (row) => fixed(row.perFrame, 1)},
    {title: 'processor', note: 's a run', numeric: true, value: (row) => row.processor, cell: (row) => fixed(row.processor, 1)},
    {title: 'processor / wall', numeric: true, value: (row) => row.ratio, cell: (row) => fixed(row.ratio, 2)},
    {title: 'used by others, most', note: 'processors', numeric: true, value: (row) => row.others, cell: (row) => fixed(row.others, 2)},
    {title: 'memory, most', note: 'MB', numeric: true, value: (row) => row.memory, cell: (row) => fixed(row.memory, 0)},
    {title: 'alone', value: (row) => (row.alone ? 'yes' : 'no')},
  ], variantCosts()));
}
