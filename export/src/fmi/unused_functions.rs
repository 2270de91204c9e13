//! The functions of the FMI 3.0 standard that a co-simulation unit must have and these units have no use for.

/// Name, type of the answer, and arguments of each.
pub(crate) const ABSENT: [(&str, &str, &str); 61] = [
    (
        "fmi3InstantiateModelExchange",
        "fmi3Instance",
        "fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logMessage",
    ),
    (
        "fmi3InstantiateScheduledExecution",
        "fmi3Instance",
        "fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption, fmi3LockPreemptionCallback unlockPreemption",
    ),
    (
        "fmi3GetFloat32",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, float v[], size_t nv",
    ),
    (
        "fmi3SetFloat32",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const float v[], size_t nv",
    ),
    (
        "fmi3GetInt8",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, int8_t v[], size_t nv",
    ),
    (
        "fmi3SetInt8",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const int8_t v[], size_t nv",
    ),
    (
        "fmi3GetUInt8",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, uint8_t v[], size_t nv",
    ),
    (
        "fmi3SetUInt8",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const uint8_t v[], size_t nv",
    ),
    (
        "fmi3GetInt16",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, int16_t v[], size_t nv",
    ),
    (
        "fmi3SetInt16",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const int16_t v[], size_t nv",
    ),
    (
        "fmi3GetUInt16",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, uint16_t v[], size_t nv",
    ),
    (
        "fmi3SetUInt16",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const uint16_t v[], size_t nv",
    ),
    (
        "fmi3GetInt32",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, int32_t v[], size_t nv",
    ),
    (
        "fmi3SetInt32",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const int32_t v[], size_t nv",
    ),
    (
        "fmi3GetUInt32",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, uint32_t v[], size_t nv",
    ),
    (
        "fmi3SetUInt32",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const uint32_t v[], size_t nv",
    ),
    (
        "fmi3GetInt64",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, int64_t v[], size_t nv",
    ),
    (
        "fmi3SetInt64",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const int64_t v[], size_t nv",
    ),
    (
        "fmi3GetUInt64",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, uint64_t v[], size_t nv",
    ),
    (
        "fmi3SetUInt64",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const uint64_t v[], size_t nv",
    ),
    (
        "fmi3GetBoolean",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, fmi3Boolean v[], size_t nv",
    ),
    (
        "fmi3SetBoolean",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const fmi3Boolean v[], size_t nv",
    ),
    (
        "fmi3GetString",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, fmi3String v[], size_t nv",
    ),
    (
        "fmi3SetString",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const fmi3String v[], size_t nv",
    ),
    (
        "fmi3GetBinary",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, size_t sizes[], fmi3Binary v[], size_t nv",
    ),
    (
        "fmi3SetBinary",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const size_t sizes[], const fmi3Binary v[], size_t nv",
    ),
    ("fmi3GetClock", "fmi3Status", "fmi3Instance i, const fmi3ValueReference vr[], size_t n, fmi3Clock v[]"),
    (
        "fmi3SetClock",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const fmi3Clock v[]",
    ),
    (
        "fmi3GetNumberOfVariableDependencies",
        "fmi3Status",
        "fmi3Instance i, fmi3ValueReference vr, size_t *count",
    ),
    (
        "fmi3GetVariableDependencies",
        "fmi3Status",
        "fmi3Instance i, fmi3ValueReference dependent, size_t dependentIndices[], fmi3ValueReference independents[], size_t independentIndices[], fmi3DependencyKind kinds[], size_t count",
    ),
    ("fmi3SerializedFMUStateSize", "fmi3Status", "fmi3Instance i, fmi3FMUState state, size_t *size"),
    (
        "fmi3SerializeFMUState",
        "fmi3Status",
        "fmi3Instance i, fmi3FMUState state, fmi3Byte bytes[], size_t size",
    ),
    (
        "fmi3DeserializeFMUState",
        "fmi3Status",
        "fmi3Instance i, const fmi3Byte bytes[], size_t size, fmi3FMUState *state",
    ),
    (
        "fmi3GetDirectionalDerivative",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity",
    ),
    (
        "fmi3GetAdjointDerivative",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity",
    ),
    ("fmi3EnterConfigurationMode", "fmi3Status", "fmi3Instance i"),
    ("fmi3ExitConfigurationMode", "fmi3Status", "fmi3Instance i"),
    ("fmi3EnterEventMode", "fmi3Status", "fmi3Instance i"),
    ("fmi3EvaluateDiscreteStates", "fmi3Status", "fmi3Instance i"),
    ("fmi3EnterContinuousTimeMode", "fmi3Status", "fmi3Instance i"),
    ("fmi3EnterStepMode", "fmi3Status", "fmi3Instance i"),
    (
        "fmi3GetIntervalDecimal",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]",
    ),
    (
        "fmi3GetIntervalFraction",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, uint64_t counters[], uint64_t resolutions[], fmi3IntervalQualifier qualifiers[]",
    ),
    (
        "fmi3GetShiftDecimal",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, fmi3Float64 shifts[]",
    ),
    (
        "fmi3GetShiftFraction",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, uint64_t counters[], uint64_t resolutions[]",
    ),
    (
        "fmi3SetIntervalDecimal",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const fmi3Float64 intervals[]",
    ),
    (
        "fmi3SetIntervalFraction",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const uint64_t counters[], const uint64_t resolutions[]",
    ),
    (
        "fmi3SetShiftDecimal",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const fmi3Float64 shifts[]",
    ),
    (
        "fmi3SetShiftFraction",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const uint64_t counters[], const uint64_t resolutions[]",
    ),
    (
        "fmi3UpdateDiscreteStates",
        "fmi3Status",
        "fmi3Instance i, fmi3Boolean *needUpdate, fmi3Boolean *terminate, fmi3Boolean *nominalsChanged, fmi3Boolean *valuesChanged, fmi3Boolean *nextDefined, fmi3Float64 *next",
    ),
    (
        "fmi3CompletedIntegratorStep",
        "fmi3Status",
        "fmi3Instance i, fmi3Boolean noSetBefore, fmi3Boolean *enterEventMode, fmi3Boolean *terminate",
    ),
    ("fmi3SetTime", "fmi3Status", "fmi3Instance i, fmi3Float64 time"),
    ("fmi3SetContinuousStates", "fmi3Status", "fmi3Instance i, const fmi3Float64 v[], size_t nv"),
    ("fmi3GetContinuousStateDerivatives", "fmi3Status", "fmi3Instance i, fmi3Float64 v[], size_t nv"),
    ("fmi3GetEventIndicators", "fmi3Status", "fmi3Instance i, fmi3Float64 v[], size_t nv"),
    ("fmi3GetContinuousStates", "fmi3Status", "fmi3Instance i, fmi3Float64 v[], size_t nv"),
    ("fmi3GetNominalsOfContinuousStates", "fmi3Status", "fmi3Instance i, fmi3Float64 v[], size_t nv"),
    ("fmi3GetNumberOfEventIndicators", "fmi3Status", "fmi3Instance i, size_t *count"),
    ("fmi3GetNumberOfContinuousStates", "fmi3Status", "fmi3Instance i, size_t *count"),
    (
        "fmi3GetOutputDerivatives",
        "fmi3Status",
        "fmi3Instance i, const fmi3ValueReference vr[], size_t n, const int32_t orders[], fmi3Float64 v[], size_t nv",
    ),
    (
        "fmi3ActivateModelPartition",
        "fmi3Status",
        "fmi3Instance i, fmi3ValueReference clock, fmi3Float64 time",
    ),
];
