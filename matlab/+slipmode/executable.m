function path = executable(new)
%EXECUTABLE  The slipmode that is run: slipmode.executable('/opt/slipmode/bin/slipmode') says which; else the one found
%   on the PATH.
  persistent known
  if nargin > 0, known = new; end
  if isempty(known), known = 'slipmode'; end
  path = known;
end
