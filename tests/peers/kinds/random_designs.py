#!/usr/bin/env python3
"""First designs of random machines whose sensors are late, or whose values have tolerances, judged by the loop that is verified.

    python3 tests/peers/kinds/random_designs.py PATH_OF_COUNTERPOISE {delays|tolerances|bandwidths} FIRST LAST [WORK_FOLDER]

A machine is drawn over seven decades of inertia: rotary or sliding; one inertia, two, a spring or an out-of-balance; no transmission, gearbox, belt,
cable, harmonic drive or ball screw; a drive that takes a torque, a current or a voltage; with and without friction; encoder, resolver, tachometer or
gyroscope, on the load or the motor; loop of rate, of position or a cascade.

delays: readings are 0.3 to 20 samples late or held for 2 to 8, the drive by up to 2.5, the control by up to 3. Margins and largest sensitivity that the first
design states must be those of the verified linear loop, within 0.1 dB, half a degree and 2 %, and the loop must be stable in every regime.

tolerances: inertias, stiffnesses, torque constant and resistance are known to 10 to 40 %. `sweep` varies them and searches the worst case: 99 % of 200 mechanisms must
keep a sensitivity of 2, and the worst case must be stable.

bandwidths: as drawn. The bandwidth of the first design is printed with what limits it, to be compared between two programs; every machine has one.

Needs nothing but Python.
"""

import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile


def logarithmic(r, low, high):
    return low * (high / low) ** r.random()


def machine(seed):
    """The text of a project file."""
    r = random.Random(seed)
    short = lambda x: f'{x:.3g}'
    sliding = r.random() < 0.4
    inertia = logarithmic(r, 1e-4, 1e3)
    kind = r.choice(['none', 'gearbox', 'belt', 'cable', 'ball_screw' if sliding else 'harmonic_drive'])
    lead = logarithmic(r, 1e-3, 4e-2)
    ratio = {'none': 1.0, 'gearbox': logarithmic(r, 10, 300), 'belt': logarithmic(r, 2, 30) * (10 if sliding else 1),
             'cable': logarithmic(r, 5, 50), 'ball_screw': 6.2832 / lead, 'harmonic_drive': r.choice([50, 100, 160])}[kind]
    force = 1.5 * inertia * logarithmic(r, 3, 100)
    plant = ['axis = "linear"'] if sliding else []
    body = r.choice(['one', 'two', 'spring', 'unbalanced'])
    if sliding and body != 'spring':
        plant.append(f'mass = {short(inertia)}')
    elif body == 'two':
        stiffness = inertia * (6.28 * logarithmic(r, 8, 200)) ** 2
        plant.append(f'lumped = {{ hub_inertia = {short(0.4 * inertia)}, beam_inertia = {short(0.6 * inertia)}, stiffness = {short(stiffness)} }}')
    elif body == 'spring':
        spring = inertia * logarithmic(r, 1, 1e3)
        plant.append(f'lumped = {{ {"mass" if sliding else "hub_inertia"} = {short(inertia)}, position_stiffness = {short(spring)} }}')
    elif body == 'unbalanced':
        plant.append(f'lumped = {{ hub_inertia = {short(inertia)}, out_of_balance = {short(r.uniform(0.05, 0.4) * force / 9.81)} }}')
    else:
        plant.append(f'inertia = {short(inertia)}')
    motor = []
    if kind != 'none':
        size = f'lead = "{short(lead)} m/rev"' if kind == 'ball_screw' else f'ratio = {short(ratio)}'
        plant.append(f'{kind} = {{ {size}, stiffness = {short(inertia * (6.28 * logarithmic(r, 5, 150)) ** 2)} }}')
        motor.append(f'inertia = {short(inertia / ratio ** 2 * logarithmic(r, 0.1, 2))}')
    constant = logarithmic(r, 0.02, 2) if kind != 'none' or not sliding else logarithmic(r, 2, 100)
    current = force / (ratio * constant)
    drive = r.choice(['torque', 'current', 'voltage'])
    if drive == 'voltage':
        volts = r.choice([12, 24, 48, 300])
        motor += [f'torque_constant = {short(constant)}', f'resistance = {short(volts / current * r.uniform(0.2, 0.6))}']
        plant.append(f'drive = {{ kind = "voltage", limit = {volts} }}')
    elif drive == 'current':
        motor.append(f'torque_constant = {short(constant)}')
        plant.append(f'drive = {{ kind = "current", limit = {short(current)}, bandwidth = "{r.choice([300, 1000, 2000])} Hz" }}')
    else:
        plant.append(f'drive = {{ limit = {short(force / ratio)} }}')
    if motor:
        plant.append(f'motor = {{ {", ".join(motor)} }}')
    if r.random() < 0.6:
        plant.append(f'friction.pivot = {{ model = "dahl", coulomb = {short(force * r.uniform(0.01, 0.15))}, '
                     f'rest_stiffness = {short(force * logarithmic(r, 50, 2e4))}, viscous = {short(inertia * logarithmic(r, 0.01, 1))} }}')
    sensor = r.choice(['encoder', 'encoder', 'resolver', 'tachometer'] + ([] if sliding else ['hub_gyro']))
    on_motor = kind != 'none' and sensor != 'hub_gyro' and r.random() < 0.5
    keys = ['place = "motor"'] if on_motor else []
    if sensor == 'encoder':
        keys.append(f'resolution = {short(logarithmic(r, 1e-8, 1e-5))}' if sliding and not on_motor else f'counts = {r.choice([4096, 20000, 131072, 1048576])}')
    else:
        keys.append(f'noise = {short(logarithmic(r, 1e-6, 1e-3))}')
    plant.append(f'sensors.{sensor} = {{ {", ".join(keys)} }}')
    plant.append(f'interface = {{ sample_period = {short(logarithmic(r, 1e-4, 5e-3))} }}')
    head = ['format = 2']
    if sensor in ('encoder', 'resolver') and r.random() < 0.5:
        head.append('synth.loop = "cascade"')
    return '\n'.join(head + ['[plant]'] + plant) + '\n'


def with_delays(seed, text):
    r = random.Random(1000 + seed)
    period = float(re.search(r'sample_period = ([\d.e+-]+)', text).group(1))
    late = f'delay = {r.choice([0.3, 0.5, 1, 1.4, 2, 5.7, 10, 20]) * period:.6g}'
    held = f'sample_period = {r.choice([2, 4, 8]) * period:.6g}'
    text = re.sub(r'(sensors\.\w+ = \{ )', lambda found: found.group(1) + r.choice([late, held]) + ', ', text)
    if 'kind = "current"' in text and r.random() < 0.5:
        text = text.replace('kind = "current"', f'kind = "current", delay = {r.choice([0.3, 1, 2.5]) * period:.6g}')
    if r.random() < 0.5:
        text = text.replace('interface = { ', f'interface = {{ output_delay_samples = {r.choice([1, 2, 3])}, ')
    return text


def with_tolerances(seed, text):
    r = random.Random(1000 + seed)
    known = r'\b(inertia|mass|hub_inertia|beam_inertia|stiffness|torque_constant|resistance) = ([\d.e+-]+)'
    return re.sub(known, lambda found: f'{found.group(1)} = {{ value = {found.group(2)}, tolerance = {r.choice([0.1, 0.2, 0.3, 0.4])} }}', text)


def run(program, command, folder):
    done = subprocess.run([program, command, folder, '-o', folder / 'out', '--json', folder / 'result.json'], capture_output=True, text=True, timeout=300)
    if done.returncode not in (0, 1):
        return done, None
    return done, json.loads((folder / 'result.json').read_text())


def judge_delays(program, folder):
    done, result = run(program, 'design', folder)
    if result is None:
        return 'refused', done.stderr.strip().splitlines()[0][:160]
    stated = [result['first_design'][key] for key in ('gain_margin_db', 'phase_margin_deg', 'max_sensitivity')]
    figures = {figure['figure']: figure['value'] for figure in result['verify']['figures']}
    verified = [figures[key] for key in ('gain_margin_db', 'phase_margin_deg', 'max_sensitivity')]
    allowed = [0.1, 0.5, 0.02 * verified[2]]
    agrees = all(abs(a - b) <= limit for a, b, limit in zip(stated, verified, allowed))
    stable = 'unstable' not in done.stdout and 'the motion grows' not in done.stdout
    words = ' '.join(f'{a:.3g}/{b:.3g}' for a, b in zip(stated, verified))
    return ('agrees' if agrees and stable else 'DIFFERS' if stable else 'UNSTABLE'), words


def judge_tolerances(program, folder):
    done, result = run(program, 'sweep', folder)
    if result is None:
        return 'refused', done.stderr.strip().splitlines()[0][:160]
    share = re.search(r'([\d.]+) % .*max_sensitivity', done.stdout)
    worst = re.search(r'worst case ([\d.]+|infinite)', done.stdout)
    held = share and float(share.group(1)) >= 99.0 and worst and worst.group(1) != 'infinite'
    return ('held' if held else 'EXCEEDED'), f'{share and share.group(1)} % of the mechanisms, worst {worst and worst.group(1)}'


def judge_bandwidth(program, folder):
    done = subprocess.run([program, 'synth', folder], capture_output=True, text=True, timeout=300)
    found = re.search(r'^bandwidth (\S+) rad/s.*?limited by: ([^;(]*)', done.stdout, re.M)
    return ('found', f'{found[1]} rad/s, {found[2].strip()}') if found else ('NONE', done.stderr.strip()[:160])


def main():
    program, kind, first, last = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    base = pathlib.Path(sys.argv[5] if len(sys.argv) > 5 else tempfile.mkdtemp())
    change, judge = {'delays': (with_delays, judge_delays), 'tolerances': (with_tolerances, judge_tolerances),
                     'bandwidths': (lambda seed, text: text, judge_bandwidth)}[kind]
    count = {}
    for seed in range(first, last):
        folder = base / f'{kind}-{seed}'
        folder.mkdir(parents=True, exist_ok=True)
        (folder / 'project.toml').write_text(change(seed, machine(seed)))
        verdict, words = judge(program, folder)
        count[verdict] = count.get(verdict, 0) + 1
        print(seed, verdict, words, flush=True)
    print(', '.join(f'{number} {verdict}' for verdict, number in sorted(count.items())))
    return 1 if any(verdict.isupper() for verdict in count) else 0


if __name__ == '__main__':
    sys.exit(main())
