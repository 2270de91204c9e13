% Reads the systems of a result as the manual shows, and compares poles and margins with those of the result.
%
%     counterpoise design PROJECT -o out --json=result.json
%     octave-cli tests/peers/results/systems.m result.json
if exist("OCTAVE_VERSION", "builtin")
    pkg load control
    % near an integrator, the matrix that is solved is nearly singular
    warning("off", "Octave:nearly-singular-matrix");
    warning("off", "Octave:singular-matrix");
end

function rate = crossing(value, low, high)
    % The place of a sign change between two rates, by bisection.
    sign_low = sign(value(low));
    for step = 1:80
        rate = (low + high) / 2;
        if sign(value(rate)) == sign_low
            low = rate;
        else
            high = rate;
        end
    end
end

arguments = argv();
result = jsondecode(fileread(arguments{1}));
plant = result.model.plant;
system = ss(plant.A, plant.B, plant.C, plant.D, plant.sample_time_s);

mine = sort(abs(pole(system)));
theirs = sort(hypot(result.model.poles_rad_s(:, 1), result.model.poles_rad_s(:, 2)));
% a pole at zero has no size of its own
off = max(abs(mine - theirs) ./ max(theirs, max(1e-3 * max(theirs), realmin)));
printf("largest relative difference of the poles %.1e\n", off);
assert(off < 1e-9);

loop = result.verify.systems(arrayfun(@(one) strcmp(one.name, "loop"), result.verify.systems));
states = numel(loop.states);
broken = ss(loop.A, reshape(loop.B, states, []), reshape(loop.C, [], states), loop.D, loop.sample_time_s);
figures = result.verify.figures;
value = @(key) figures(arrayfun(@(one) strcmp(one.figure, key), figures)).value;
period = loop.sample_time_s;
at = @(rate) broken.c * ((exp(1i * rate * period) * eye(states) - broken.a) \ broken.b) + broken.d;

% every crossing of the negative real axis and of the unit circle; the smallest margin counts
rates = logspace(-2, log10(0.999 * pi / period), 4000);
values = arrayfun(at, rates);
gain = Inf;
phase = Inf;
for k = find(imag(values(1:end - 1)) .* imag(values(2:end)) < 0)
    rate = crossing(@(rate) imag(at(rate)), rates(k), rates(k + 1));
    db = -20 * log10(abs(at(rate)));
    if real(at(rate)) < 0 && db > 0
        gain = min(gain, db);
    end
end
for k = find((abs(values(1:end - 1)) - 1) .* (abs(values(2:end)) - 1) < 0)
    rate = crossing(@(rate) abs(at(rate)) - 1, rates(k), rates(k + 1));
    phase = min(phase, abs(arg(-at(rate))) * 180 / pi);
end
printf("gain margin %.10f dB against %.10f dB, phase margin %.10f deg against %.10f deg\n", ...
    gain, value("gain_margin_db"), phase, value("phase_margin_deg"));
assert(abs(gain - value("gain_margin_db")) < 1e-9 * value("gain_margin_db"));
assert(abs(phase - value("phase_margin_deg")) < 1e-9 * value("phase_margin_deg"));
