% The MATLAB package, as Octave runs it.
function test_slipmode()
  addpath(fullfile(getenv('SLIPMODE_SOURCE_DIR'), 'matlab'));
  slipmode.executable(getenv('SLIPMODE_EXECUTABLE'));
  datasets = fullfile(getenv('SLIPMODE_SOURCE_DIR'), 'datasets');
  backlash = fullfile(datasets, 'backlash_sdof', 'scene.toml');

  % In the gap the mass is free but for c = 0.05: multipliers 1 and exp(-c T), T = 2 pi / 1.4.
  [report, data] = slipmode.call('orbit find', backlash);
  expect(strcmp(report.verb, 'orbit find'));
  expect(abs(data.orbit.multipliers(:, 1) - [1; exp(-0.05 * 2 * pi / 1.4)]) < 1e-10);
  expect(size(data.trajectory.q) == [1001, 1]);
  expect(~isfield(report, 'file') || ~exist(report.file, 'file'));  % the temporary file is gone

  % Options: rows of numbers, flags, repeated ones; a folder with a blank and a quote; what is kept, read again.
  folder = fullfile(tempname(), 'it''s ours');
  mkdir(folder);
  clean = onCleanup(@() cellfun(@(x) rmdir(x, 's'), {fileparts(folder)}));
  file = fullfile(folder, 'branch.h5');
  [report, data] = slipmode.call('orbit continue', backlash, 'over', 'drive.omega=1.4:1.3', 'start', [2.5, 0], ...
                                 'sequential', true, 'max_step', 0.05, 'output', file, ...
                                 'set', {'drive.amplitude=1.0', 'time.cycles=500'});
  expect(exist(file, 'file') == 2);
  points = data.branches.x0.points;
  expect(abs(points.parameter([1, end]) - [1.4; 1.3]) < 1e-12);
  again = slipmode.read(file);
  expect(isequal(again.branches.x0.points.period, points.period));
  expect(abs(points.period .* points.parameter - 2 * pi) < 1e-12);

  % Files as a column, an option repeated with numbers.
  orbit = fullfile(folder, 'orbit.h5');
  slipmode.call('orbit find', backlash, 'output', orbit);
  [~, lines] = slipmode.call('orbit spectrum', {orbit}', 'dof', {1}, 'harmonics', 2);
  expect(size(lines.spectrum.coefficients.q1_cosine) == [3, 1]);

  refused('slipmode:InvalidInput', 'omega', @() slipmode.call('orbit find', backlash, 'set', 'drive.omega=x'));
  refused('slipmode:InvalidInput', 'no such scene', @() slipmode.call('orbit find', 'none.toml'));
  refused('slipmode:InvalidInput', 'pairs', @() slipmode.call('orbit find', backlash, 'start'));
  refused('slipmode:NumericalFailure', 'no orbit', ...
          @() slipmode.call('orbit find', backlash, 'start', [2.5, 0], 'order', 7, 'iterations', 1));
  slipmode.executable('/none/slipmode');
  refused('slipmode:NoExecutable', '/none/slipmode', @() slipmode.call('orbit find', backlash));
  disp('all hold');
end

function expect(holds)
  if ~all(holds(:)), error('does not hold'); end
end

function refused(identifier, words, call)
  try
    call();
  catch failure
    if ~strcmp(failure.identifier, identifier) || isempty(strfind(failure.message, words)), rethrow(failure); end
    return;
  end
  error('not refused: %s', words);
end
