"""Enumerates every numeric leaf of a JSON result of `counterpoise model`, `reduce`, `synth`, `verify` and `design`, and says of each what it is:

- data: what figures are computed from (matrices, weights, time histories, limits, numbers of the project);
- recomputed: a figure that recompute.py computes anew;
- listed: a figure that the result does not determine, with the reason.

    counterpoise design PROJECT -o out --histories --json=result.json
    python tests/peers/results/leaves.py result.json [--controller out/controller.json] [--prove]

The script fails if a leaf is of no class. With --prove it changes one leaf of every recomputed kind by one percent, and fails unless
recompute.py then finds a difference: so "recomputed" is not a claim of this table.
"""

import copy
import re
import sys

import recompute

SYSTEM = r"[ABCD]\.\d+\.\d+|sample_time_s"
DATA, RECOMPUTED = "data", "recomputed"

BY_OBSERVER = "the describing function of a friction observer: its law stands in controller.json, which --controller names"
BY_ROUNDING = "the rounding of every operation of the generated code: its self test and `counterpoise design` compare them with the compiled code"

# (pattern of the whole path, class or reason). The first that matches counts.
CLASSES = [
    # systems, responses, histories
    (rf".*(systems(\.\d+)+|plant|plant_before|design_plant|sampled_loop|controllers\.\d+|paths\.\d+|module|sensor|true_sensor|feedback|generalised"
     rf"|on_generalised|closed_loops\.\d+|loops\.\d+|path_forms\.\d+\.system)\.({SYSTEM})", DATA),
    (r".*paths\.\d+\.(system|scaling)\..*", DATA),
    (r".*paths\.\d+\.anti_windup\.\d+", "a gain of the limiter, which no linear figure depends on; the histories run with it"),
    (r".*responses\.\d+\.frequency_hz\.\d+", DATA),
    (r".*responses\.\d+\.(real|imaginary)\.\d+", RECOMPUTED),
    (r".*(histories\.\d+|history)\..*", DATA),
    (r".*\.(rest_rates_rad_s|motion_rates_rad_s|errors_rad_s|hub_rad|tip_rad)\.\d+", DATA),
    (r".*(control_delay_samples|reading_delays_samples\.\d+|settle_s)", DATA),
    # model
    (r"model\.(order|holding_v|poles_rad_s\.\d+\.\d+)", RECOMPUTED),
    (r"model\.(out_of_balance_kg_m|balance\..*|assumptions\.\d+\.(value|usual\.\d+))", DATA),
    (r"model\.assumption_effects\.\d+\.(value|at\.\d+\.value)", DATA),
    (r".*\.(assumed_loop|measured_on)\.holding_v|verify\.holding_v", RECOMPUTED),
    (r"(.*\.(assumed_loop|measured_on)|verify)\.(out_of_balance_kg_m|balance\..*)", DATA),
    (r"model\.assumption_effects\.\d+\.(largest_change_db|at\.\d+\.(is_stable|\w+_change_(db|deg)))", RECOMPUTED),
    (r"model\.structure\.(elements\..*|beam\..*|meshes\.reference|meshes\.\w+\.\d+\.elements)", DATA),
    (r"model\.structure\.(modes\..*|meshes\..*)", RECOMPUTED),
    (r"model\.frictions\.\d+\.(steady\..*|loops\.\d+\.(points|over_rate)\..*)", DATA),
    (r"model\.frictions\.\d+\.loops\.\d+\..*", RECOMPUTED),
    (r"model\.accuracy\.\d+\.order", RECOMPUTED),
    (r"model\.accuracy\.\d+\.(step_s\.\d+|sticks)", DATA),
    (r"model\.accuracy\..*", "errors of the simulator's own runs against those of its second method, which the result does not contain"),
    # reduce
    (r"reduce\.(order\.\d+|bound|error\.\d+)", RECOMPUTED),
    (r"reduce\.ranked\.\d+", RECOMPUTED),
    # synth
    (r"synth\.weights\.\d+\.(denominator|numerator)\.\d+", DATA),
    (r"synth\.weights\.\d+\.(gain|(zeros|poles)\.\d+\.\d+)", RECOMPUTED),
    (r"synth\.(plant_order|path_orders\..*|largest_pole_modulus|closed_loop_poles\.\d+\.\d+)", RECOMPUTED),
    (r"synth\.cost_difference", RECOMPUTED),
    (r"synth\.costs\.\d+\.(predicted|achieved)", DATA),
    (r".*beside\.(total_cost\.basis|balance_basis\.\d+\.(nominal|redesign)|methods\.\d+\.problem\.basis)\..*", DATA),
    (r".*beside\.methods\.\d+\.problem\.(error|control)_weight\..*", DATA),
    (r".*beside\.(total_cost\..*|motions\..*|methods\.\d+\.(figures\..*|norm|integral|order))", RECOMPUTED),
    (r".*beside\.tuned_pi\.(disturbance\.\d+\.\d+|reading_noise_\w+|blocks\.\d+\.values\.\d+\.1)", DATA),
    (r".*beside\.tuned_pi\.(own\.\w+|tuned\.\w+|limits\.\w+|missed)", RECOMPUTED),
    (r".*beside\.spillover\.(modes|order)", DATA),
    (r".*beside\.spillover\.(largest_pole|poles\..*)", RECOMPUTED),
    (r".*beside\.lowered\.((before|after)\..*|loop_change|order\.\d+)", RECOMPUTED),
    (r".*beside\.balance\.\d+\.out_of_balance_kg_m", DATA),
    (r".*beside\.balance\..*", RECOMPUTED),
    # verify
    (r"verify\.figures\.\d+\.value", RECOMPUTED),
    (r"verify\.verdicts\.\d+\.limit", DATA),
    (r"verify\.(verdicts\.\d+\.value|passes)", RECOMPUTED),
    (r"verify\.robust_to_times_the_ranges", RECOMPUTED),
    (r"verify\.robustness\.\d+\.(pulled\..*|bounds\.\d+\.([DG]\..*|perturbation\..*|frequency_hz)|ranges\..*|errors\.\d+)", DATA),
    (r"verify\.robustness\.\d+\.nearest\.(systems\..*|deltas\.\d+|phases\..*|scale)", DATA),
    (r"verify\.robustness\.\d+\.(guaranteed|worst_hz|bounds\.\d+\.(upper|lower)|nearest\..*)", RECOMPUTED),
    (r"verify\.robustness\.\d+\.dry_friction_at_rad_s", DATA),
    (r"verify\.certificate\.cases\.\d+\.regimes\.\d+\.(gain_margin_db|max_sensitivity|pole_radius|growth_per_s|frequency_hz)", RECOMPUTED),
    (r"verify\.certificate\.cases\.\d+\.sector\.multiplier\..*", DATA),
    (r"verify\.certificate\.cases\.\d+\.sector\.range_hz\.\d+", DATA),
    (r"verify\.certificate\.cases\.\d+\.sector\.(holds|least|aliases|frequency_hz)", RECOMPUTED),
    (r"verify\.certificate\.cases\.\d+\.sector\.intervals", "how finely this program's own proof divides the range; the condition is checked at 4000 points"),
    (r"verify\.certificate\.(cases\.\d+\.)?proved", RECOMPUTED),
    (r"verify\.certificate\.cases\.\d+\.orbits\.\d+\.rates_rad_s\.\d+", DATA),
    (r"verify\.certificate\.cases\.\d+\.orbits\.\d+\.(amplitude_rad_s|frequency_hz)", RECOMPUTED),
    (r"verify\.certificate\.cases\.\d+\.orbits\.\d+\.start_rad_s", DATA),
    (r"verify\.certificate\.cases\.\d+\.limit_cycle\..*", RECOMPUTED),
    (r"verify\.certificate\.cases\.\d+\.predicted\.\d+\.balances\.\d+\.(systems\..*|joints\.\d+\.(torque_nm\.\d+|dahl_\w+)|gear_ratio|mesh\.(wind_up_rad|pressed_rad|gap_rad))", DATA),
    (r"verify\.certificate\.cases\.\d+\.predicted\.\d+\.balances\.\d+\.observers.*", BY_OBSERVER),
    (r"verify\.certificate\.cases\.\d+\.predicted.*", RECOMPUTED),
    (r"verify\.certificate\.cases\.\d+\.(out_of_balance_kg_m|reading_noise_rad_s|reading_step_rad_s)", DATA),
    (r"verify\.certificate\.cases\.\d+\.(rest_rms_rad_s|motion_growth|noise_floor_rad_s)", RECOMPUTED),
    (r"verify\.advice\.\d+\.(limit|sensitivities\.\d+\.tried\.factor|change\.(factor|tried\.factor))", DATA),
    (r"verify\.advice\.\d+\..*", RECOMPUTED),
    (r"verify\.sight_procedure\..*", DATA),
    (r"verify\.error_budget\.runs\.\d+\.sample_time_s", DATA),
    (r"verify\.error_budget\..*", RECOMPUTED),
    (r"verify\.adaptation_trials\.bands\..*", DATA),
    (r"verify\.adaptation_trials\..*", RECOMPUTED),
    # design
    (r"certificates\.\d+\.value", RECOMPUTED),
    (r"certificates\.\d+\.holds", "the value against a limit of the program"),
    (r"targets\.numbers\.\d+\.experiments\.\d+\.(error_rms_rad_s|cost_db)", RECOMPUTED),
    (r"targets\.numbers\.\d+\.(predicted|worst|measured)\w*", BY_ROUNDING),
    (r"targets\.path_forms\.\d+\.(coefficients|predicted|measured)", RECOMPUTED),
    (r"targets\.path_forms\.\d+\.is_in_use", DATA),
    (r"targets\.by_form\.\d+\.multiplications|targets\.instructions_by_hand", RECOMPUTED),
    (r"targets\.by_form\.\d+\.(double|single)\w*", BY_ROUNDING),
    (r"targets\.(multiplications|additions|states)", DATA),
    (r"targets\.(compiled|cores)\..*", "what a compiler and an emulator answered about the generated code"),
    (r"first_design\.(bandwidth_rad_s|gain_margin_db|phase_margin_deg|max_sensitivity\w*|limits\.\d+\.over_reached)", RECOMPUTED),
    (r"first_design\.limits\.\d+\.used", "of margins and shifted modes it is recomputed; the others' plants, noise and steps are not in the result"),
    (r"first_design\.asked_rad_s", DATA),
    (rf"first_design\.limits\.\d+\.(lifted_)?shown_by\.({SYSTEM})", DATA),
    (r"first_design\.limits\.\d+\.(bandwidth_rad_s|lifted_rad_s)", RECOMPUTED),
    (r"first_design\.(required\.\w+|sample_period_s)", DATA),
]


def walk(node, path=()):
    if isinstance(node, dict):
        for key, value in node.items():
            yield from walk(value, path + (key,))
    elif isinstance(node, list):
        for k, value in enumerate(node):
            yield from walk(value, path + (k,))
    elif isinstance(node, (bool, int, float)):
        yield path


def stage(result):
    """The stage that a result of one stage is of; None for a design."""
    if "synth" in result:
        return None
    return next((name for key, name in (("poles_rad_s", "model"), ("ranked", "reduce"), ("path_orders", "synth")) if key in result), "verify")


def classified(result):
    """Kinds of leaves (paths whose places in lists are left open) with their class and one path of each list."""
    first, kinds = stage(result), {}
    exported = result.get("verify", result).pop("exported_controller", None)
    classes = [(pattern, RECOMPUTED if exported and one == BY_OBSERVER else one) for pattern, one in CLASSES]
    for path in walk(result):
        whole = ".".join(map(str, ((first,) if first else ()) + path))
        kind = re.sub(r"\.\d+(?=\.|$)", ".*", whole)
        if kind not in kinds:
            found = next((one for pattern, one in classes if re.fullmatch(pattern, whole)), None)
            kinds[kind] = [found, []]
        kinds[kind][1].append(path)
    if exported:
        result.get("verify", result)["exported_controller"] = exported
    return kinds


def value_at(result, path):
    for key in path:
        result = result[key]
    return result


def is_noticed(result, path):
    """Whether the recomputation differs after one leaf has changed by a percent of itself, or a truth has turned."""
    changed = copy.deepcopy(result)
    holder, old = value_at(changed, path[:-1]), value_at(changed, path)
    holder[path[-1]] = (not old) if isinstance(old, bool) else old + 1 if isinstance(old, int) else 1.01 * old
    for _, value, mine, *allowed in recompute.rows_of(changed):
        if allowed and not recompute.difference_of(value, mine, allowed[0]) <= allowed[0]:
            return True
    return False


def proofs(result, kinds):
    """The recomputed kinds of which no changed leaf was noticed. The largest leaf of a kind is changed, then others: of a pair, say, the
    real part alone may be what is printed."""
    for kind, (found, paths) in kinds.items():
        numbers = [path for path in paths if value_at(result, path) not in (0, 0.0, None)]
        if found != RECOMPUTED or not (numbers or isinstance(value_at(result, paths[0]), bool)):
            continue
        tried = sorted(numbers, key=lambda path: -abs(value_at(result, path))) or paths
        tried = [tried[k] for k in sorted({0, len(tried) // 2, len(tried) // 4})]
        if not any(is_noticed(result, path) for path in tried):
            yield kind


def main(path, *options):
    result = recompute.loaded(path, *options)
    kinds = classified(result)
    counts, listed, wrong = {}, {}, []
    for kind, (found, paths) in kinds.items():
        name = found if found in (DATA, RECOMPUTED) else "listed"
        if found is None:
            wrong.append(f"  UNLISTED {kind}: {len(paths)} numbers are neither data, nor recomputed, nor listed with a reason")
            continue
        counts[name] = counts.get(name, 0) + len(paths)
        if name == "listed":
            listed.setdefault(found, []).append(f"{kind} ({len(paths)})")
    print(f"{sum(counts.values())} numbers of {len(kinds)} kinds: " + ", ".join(f"{count} {name}" for name, count in sorted(counts.items())))
    for reason, names in listed.items():
        print(f"  listed: {', '.join(names)}: {reason}")
    if "--prove" in options:
        recomputed = sum(found == RECOMPUTED for found, _ in kinds.values())
        unnoticed = list(proofs(result, kinds))
        wrong += [f"  UNNOTICED {kind}: a change by a percent is not found" for kind in unnoticed]
        print(f"{recomputed - len(unnoticed)} of {recomputed} recomputed kinds: a change by a percent is found")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
