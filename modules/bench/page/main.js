// Puts the page together, and keeps what is chosen in the address, so that a link shows the same.

const chosen = {quantity: 'ate_m', statistic: 'rmse', ...Object.fromEntries(new URLSearchParams(location.hash.slice(1)))};
if (!quantities[chosen.quantity]) chosen.quantity = 'ate_m';
if (!statistics[chosen.statistic]) chosen.statistic = 'rmse';

function remember(changes) {
  Object.assign(chosen, changes);
  const parameters = new URLSearchParams();
  for (const key of ['quantity', 'statistic', 'sequence', 'plane', 'runs'])
    if (chosen[key] !== undefined) parameters.set(key, chosen[key]);
  history.replaceState(null, '', `#${parameters}`);
}

function showHead() {
  byId('about').replaceChildren(...withCode(results.about));
  const done = results.runs.filter((run) => run.result !== null);
  const troubled = done.filter(hasTrouble);
  const facts = [
    `${done.length} of ${counted(results.runs.length, 'run')} done`, `${done.filter((run) => run.counts).length} with a result that counts`,
    counted(results.variants.length, 'variant'), counted(results.sequences.length, 'sequence'), results.matrix,
  ];
  fill('facts', facts.map((fact) => element('li', {}, fact)));
  const notices = [];
  if (!results.complete)
    notices.push(element('p', {class: 'notice'}, element('b', {}, 'Unfinished'), ': what follows is about the runs that are done.'));
  if (troubled.length > 0)
    notices.push(element('p', {class: 'notice'}, element('b', {}, `${counted(troubled.length, 'run')} with trouble`),
                         ' (did not finish, left no errors, short, or what is no pose): ',
                         element('a', {href: '#runs', onclick: () => {
                           byId('only-trouble').checked = true;
                           byId('only-trouble').dispatchEvent(new Event('change'));
                         }}, 'show them'), '.'));
  fill('state', notices);
}

function showQuantity() {
  showComparisons(chosen.quantity);
  showErrors(chosen.quantity, chosen.statistic);
  showImprovements(chosen.quantity);
}

makeChoice('quantity', Object.fromEntries(Object.entries(quantities).map(([key, quantity]) => [key, quantity.name])), chosen.quantity, (quantity) => {
  remember({quantity});
  showQuantity();
});
makeChoice('statistic', statistics, chosen.statistic, (statistic) => {
  remember({statistic});
  showErrors(chosen.quantity, statistic);
});
showHead();
showQuantity();
showRobustness();
showPublished();
showPaperTables();
byId('citation').textContent = citationLine;
showCost();
showStages(false);
byId('with-decoding').addEventListener('change', (event) => showStages(event.target.checked));

const section = new TrajectorySection(remember);
const asked = results.sequences.findIndex((sequence) => sequence.name === chosen.sequence);
section.choose(section.sequences.includes(asked) ? asked : section.sequences[0],
               asked >= 0 && chosen.runs !== undefined ? chosen.runs.split(',') : null, planes[chosen.plane] ? chosen.plane : null);

const showTrajectory = (run) => {
  section.choose(run.sequence, [run.id]);
  byId('trajectories').scrollIntoView();
};
showRuns(false, showTrajectory);
byId('only-trouble').addEventListener('change', (event) => showRuns(event.target.checked, showTrajectory));
// Links to a section must not push what is chosen out of the address.
for (const link of document.querySelectorAll('a[href^="#"]'))
  link.addEventListener('click', (event) => {
    event.preventDefault();
    document.querySelector(link.getAttribute('href')).scrollIntoView();
  });
// No link leads to a section that has nothing to show.
for (const link of document.querySelectorAll('nav a'))
  link.hidden = document.querySelector(link.getAttribute('href')).hidden;
document.addEventListener('themechange', () => section.show());
