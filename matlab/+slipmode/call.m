function [report, data] = call(verb, subjects, varargin)
%CALL  One verb of slipmode: what it says, and what it computed.
%   report = slipmode.call(VERB, SUBJECTS, NAME, VALUE, ...) runs `slipmode VERB SUBJECTS --NAME VALUE ... --json` and
%   gives its JSON as a struct. SUBJECTS is a file, or a cell array of files. An option's value is a number, a row of
%   numbers, a text, true for a flag, or a cell array for an option that is repeated:
%
%       report = slipmode.call('orbit find', 'scene.toml', 'start', [2.5 0], 'set', {'drive.omega=1.2', 'time.duration=50'});
%
%   [report, data] = slipmode.call(...) also reads what the verb wrote (see slipmode.read): the file that the option
%   'output' names, else a temporary one that is removed.
%
%   Errors: slipmode:Interrupted; slipmode:InvalidInput names key, value and remedy; slipmode:NumericalFailure is a computation that could not
%   be completed. `slipmode VERB --help` lists the options.
  if mod(numel(varargin), 2) ~= 0
    error('slipmode:InvalidInput', '%s: options come as pairs of name and value', verb);
  end
  words = [strsplit(verb, ' '), reshape(cellstr(subjects), 1, [])];
  output = '';
  for k = 1:2:numel(varargin)
    words = [words, option(varargin{k}, varargin{k + 1})];  %#ok<AGROW>
    if strcmp(varargin{k}, 'output'), output = varargin{k + 1}; end
  end
  temporary = nargout > 1 && isempty(output);
  if temporary
    output = [tempname(), '.h5'];
    remove = onCleanup(@() remove_file(output));
    words = [words, {'--output', output}];
  end
  said = [tempname(), '.json'];
  complaints = [tempname(), '.txt'];
  forget = onCleanup(@() cellfun(@remove_file, {said, complaints}));
  quoted = cellfun(@shell_word, [{slipmode.executable()}, words, {'--json'}], 'UniformOutput', false);
  code = system(sprintf('%s > %s 2> %s', strjoin(quoted, ' '), shell_word(said), shell_word(complaints)));
  text = fileread(said);
  if isempty(strtrim(text))
    error('slipmode:NoExecutable', '%s: %s', slipmode.executable(), strtrim(fileread(complaints)));
  end
  report = jsondecode(text);
  if code ~= 0
    kind = 'slipmode:InvalidInput';
    if code == 3, kind = 'slipmode:NumericalFailure'; end
    if code == 130, kind = 'slipmode:Interrupted'; end
    error(kind, '%s', strtrim(report.message));
  end
  if nargout > 1, data = slipmode.read(output); end
end

function words = option(name, value)
  name = ['--', strrep(name, '_', '-')];
  if islogical(value)
    words = repmat({name}, 1, value);
    return;
  end
  if ~iscell(value), value = {value}; end
  texts = cellfun(@text_of, value(:)', 'UniformOutput', false);
  words = reshape([repmat({name}, 1, numel(texts)); texts], 1, []);
end

function text = text_of(value)
  if isnumeric(value)
    text = strjoin(arrayfun(@(x) sprintf('%.17g', x), value(:)', 'UniformOutput', false), ',');
  else
    text = char(value);
  end
end

function word = shell_word(text)
  word = ['''', strrep(text, '''', '''\'''''), ''''];
end

function remove_file(path)
  if exist(path, 'file'), delete(path); end
end
