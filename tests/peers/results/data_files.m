% Loads result.mat in Octave and compares the matrices of the plant with those of the JSON result:
%
%     octave-cli data_files.m out/data/result.mat result.json
%
% Ends with an error if a system or a history is missing or a number differs.
arguments = argv();
loaded = load(arguments{1});
expected = jsondecode(fileread(arguments{2}));
count = 0;
function count = compare(found, expected, name)
  for key = {"A", "B", "C", "D"}
    one = found.(key{1});
    other = expected.(key{1});
    % jsondecode of Octave may miss the nearest number by a bit or two; the numbers of the MATLAB file are exact (data_files.py)
    assert(all(abs(one(:) - other(:)) <= 4 * eps * abs(other(:))), "%s.%s differs", name, key{1});
  end
  states = numel(found.states);
  assert(size(found.A), [states, states]);
  assert(size(found.B), [states, numel(found.inputs)]);
  assert(found.sample_time_s == expected.sample_time_s);
  count = 1;
end
if isfield(loaded, "model") && isfield(loaded.model, "plant")
  count += compare(loaded.model.plant, expected.model.plant, "model.plant");
end
if isfield(loaded, "plant")
  count += compare(loaded.plant, expected.plant, "plant");
end
if isfield(loaded, "reduce")
  count += compare(loaded.reduce.plant, expected.reduce.plant, "reduce.plant");
  count += compare(loaded.synth.design_plant, expected.synth.design_plant, "synth.design_plant");
  for k = 1:numel(loaded.synth.controllers)
    one = expected.synth.controllers;
    if iscell(one) one = one{k}; else one = one(k); end
    count += compare(loaded.synth.controllers(k), one, one.name);
  end
end
assert(count > 0, "there is no system");
printf("Octave %s: %d systems are the same\n", version(), count);
