function data = read(file)
%READ  All of a result file as a struct: data.trajectory.q, data.orbit.multipliers, ...
%   Names, shapes and units are those of `slipmode info FILE`: rows of data.trajectory.q are instants. A name that is
%   none of MATLAB's gets an x before it (branches.x0). What is not finite is NaN in an array and [] by
%   itself. Where h5read is, it reads one array of a large file faster: h5read(file, '/trajectory/q'), with the
%   dimensions in reverse order.
  data = slipmode.call('info', file, 'values', true);
  data = rmfield(data, intersect(fieldnames(data), {'status', 'exit_code'}));
end
