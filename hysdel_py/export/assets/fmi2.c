/* Co-simulation interface of FMI 2.0 around one step function. The model is in fmu_model.h.
 *
 * A step belongs to each sample time. At a sample instant the outputs follow states and inputs at once; as soon as time
 * goes on the inputs are held, and with them the outputs, until the next instant. */
#include "fmu_model.h"

#include <float.h>
#include <stddef.h>
#include <string.h>

/* Types and values of the standard, stated here so that no other header is needed. */
typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#ifdef FMI2_FUNCTION_PREFIX
#define JOINED_(a, b) a##b
#define JOINED(a, b) JOINED_(a, b)
#define NAME(name) JOINED(FMI2_FUNCTION_PREFIX, name)
#define PUBLIC
#else
#define NAME(name) name
#if defined _WIN32 || defined __CYGWIN__
#define PUBLIC __declspec(dllexport)
#elif defined __GNUC__
#define PUBLIC __attribute__((visibility("default")))
#else
#define PUBLIC
#endif
#endif

enum phase { INSTANTIATED, INITIALIZING, RUNNING, TERMINATED };

/* All that changes: a snapshot is a copy of it. */
typedef struct {
    double value[COUNT + 1]; /* states, inputs, outputs, Booleans, reals; behind them the status of the step */
    double next[COUNT + 1];  /* states of the next sample instant */
    double start, now;
    long done;               /* samples since the start */
    int phase, fresh, held;
} Data;

typedef struct {
    Data data;
    fmi2CallbackFunctions call;
    int logging;
    char *name;
} Instance;

static void tell(Instance *one, fmi2Status status, const char *text)
{
    if (one->call.logger != NULL && (one->logging || status >= fmi2Error))
        one->call.logger(one->call.componentEnvironment, one->name, status,
                         status >= fmi2Error ? "logStatusError" : "logStatusWarning", "%s", text);
}

static fmi2Status wrong(Instance *one, const char *text)
{
    tell(one, fmi2Error, text);
    return fmi2Error;
}

static void begin(Data *data)
{
    int i;
    memset(data, 0, sizeof *data);
    for (i = 0; i < COUNT; i++)
        data->value[i] = initial_value[i];
}

/* Outputs and next states from states and inputs. */
static fmi2Status evaluate(Instance *one)
{
    Data *data = &one->data;
    double *v = data->value;
    int status;
    if (data->fresh || data->held)
        return fmi2OK;
    status = MODEL_STEP(v, v + U, data->next, v + Y, v + D, v + Z);
    v[COUNT] = status;
    if (status & MODEL_INVALID)
        return wrong(one, "a state or an input is not finite, or a Boolean is neither 0 nor 1: there is no step");
    data->fresh = 1;
    return fmi2OK;
}

static fmi2Status remark(Instance *one)
{
    const int status = (int)one->data.value[COUNT];
    fmi2Status worst = fmi2OK;
    size_t i;
    for (i = 0; i < sizeof remarks / sizeof *remarks; i++)
        if (status & remarks[i].bit) {
            tell(one, fmi2Warning, remarks[i].text);
            worst = fmi2Warning;
        }
    return worst;
}

static double instant(const Data *data, long samples)
{
    return data->start + (double)(data->done + samples) * SAMPLE_TIME;
}

/* How far two times may lie apart that are the same: importers add up steps, and large times have coarse digits. */
static double slack(double time)
{
    return TIME_SLACK * SAMPLE_TIME + 8.0 * DBL_EPSILON * (time < 0.0 ? -time : time);
}

/* Move the time to an end that does not lie before it. */
static fmi2Status advance(Instance *one, double end)
{
    Data *data = &one->data;
    fmi2Status worst = fmi2OK;
    while (end > instant(data, 0) + slack(end)) {
        if (!data->held) {
            if (evaluate(one) != fmi2OK)
                return fmi2Error;
            if (remark(one) > worst)
                worst = fmi2Warning;
            data->held = 1;
        }
        if (end < instant(data, 1) - slack(end))
            break;
        memcpy(data->value, data->next, U * sizeof(double));
        data->done++;
        data->held = data->fresh = 0;
    }
    data->now = end;
    return worst;
}

static int is_type(fmi2ValueReference vr, char type)
{
    return vr <= COUNT && value_type[vr] == type;
}

static fmi2Status get(Instance *one, const fmi2ValueReference vr[], size_t n, char type, double *reals, int *integers)
{
    size_t i;
    for (i = 0; i < n; i++)
        if (!is_type(vr[i], type))
            return wrong(one, "a value reference does not exist or has another type");
    if (n > 0 && evaluate(one) != fmi2OK)
        return fmi2Error;
    for (i = 0; i < n; i++)
        if (reals != NULL)
            reals[i] = one->data.value[vr[i]];
        else
            integers[i] = (int)one->data.value[vr[i]];
    return fmi2OK;
}

static fmi2Status set(Instance *one, const fmi2ValueReference vr[], size_t n, char type, const double *reals,
                      const int *booleans)
{
    size_t i;
    for (i = 0; i < n; i++) {
        if (!is_type(vr[i], type) || vr[i] >= Y)
            return wrong(one, "only inputs and first states can be set, each by its own type");
        if (vr[i] < U && one->data.phase > INITIALIZING)
            return wrong(one, "a state can be set before the end of the initialization only");
        one->data.value[vr[i]] = reals != NULL ? reals[i] : (double)(booleans[i] != 0);
        one->data.fresh = 0;
    }
    return fmi2OK;
}

PUBLIC const char *NAME(fmi2GetTypesPlatform)(void)
{
    return "default";
}

PUBLIC const char *NAME(fmi2GetVersion)(void)
{
    return "2.0";
}

PUBLIC fmi2Component NAME(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                           const fmi2CallbackFunctions *call, fmi2Boolean visible, fmi2Boolean logging)
{
    Instance *one;
    (void)resources;
    (void)visible;
    if (call == NULL || call->allocateMemory == NULL || call->freeMemory == NULL)
        return NULL;
    one = call->allocateMemory(1, sizeof *one);
    if (one == NULL)
        return NULL;
    one->call = *call;
    one->logging = logging;
    one->name = call->allocateMemory((name == NULL ? 0 : strlen(name)) + 1, 1);
    if (one->name != NULL && name != NULL)
        strcpy(one->name, name);
    begin(&one->data);
    if (one->name == NULL || type != fmi2CoSimulation || guid == NULL || strcmp(guid, MODEL_GUID) != 0) {
        tell(one, fmi2Error, "co-simulation and the GUID of the model description were expected");
        call->freeMemory(one->name);
        call->freeMemory(one);
        return NULL;
    }
    return one;
}

PUBLIC void NAME(fmi2FreeInstance)(fmi2Component c)
{
    Instance *one = c;
    if (one == NULL)
        return;
    one->call.freeMemory(one->name);
    one->call.freeMemory(one);
}

PUBLIC fmi2Status NAME(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)n;
    (void)categories;
    ((Instance *)c)->logging = on;
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                            fmi2Real start, fmi2Boolean has_stop, fmi2Real stop)
{
    Instance *one = c;
    (void)has_tolerance;
    (void)tolerance;
    (void)has_stop;
    (void)stop;
    one->data.start = one->data.now = start;
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2EnterInitializationMode)(fmi2Component c)
{
    ((Instance *)c)->data.phase = INITIALIZING;
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2ExitInitializationMode)(fmi2Component c)
{
    ((Instance *)c)->data.phase = RUNNING;
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2Terminate)(fmi2Component c)
{
    ((Instance *)c)->data.phase = TERMINATED;
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2Reset)(fmi2Component c)
{
    begin(&((Instance *)c)->data);
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    return get(c, vr, n, 'r', value, NULL);
}

PUBLIC fmi2Status NAME(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[])
{
    return get(c, vr, n, 'i', NULL, value);
}

PUBLIC fmi2Status NAME(fmi2GetBoolean)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[])
{
    return get(c, vr, n, 'b', NULL, value);
}

PUBLIC fmi2Status NAME(fmi2GetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[])
{
    (void)vr;
    (void)value;
    return n == 0 ? fmi2OK : wrong(c, "there are no strings");
}

PUBLIC fmi2Status NAME(fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
    return set(c, vr, n, 'r', value, NULL);
}

PUBLIC fmi2Status NAME(fmi2SetInteger)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer value[])
{
    (void)vr;
    (void)value;
    return n == 0 ? fmi2OK : wrong(c, "there are no integers to set");
}

PUBLIC fmi2Status NAME(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean value[])
{
    return set(c, vr, n, 'b', NULL, value);
}

PUBLIC fmi2Status NAME(fmi2SetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[])
{
    (void)vr;
    (void)value;
    return n == 0 ? fmi2OK : wrong(c, "there are no strings");
}

PUBLIC fmi2Status NAME(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    Instance *one = c;
    if (*state == NULL)
        *state = one->call.allocateMemory(1, sizeof(Data));
    if (*state == NULL)
        return wrong(one, "no memory for a snapshot");
    memcpy(*state, &one->data, sizeof(Data));
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    memcpy(&((Instance *)c)->data, state, sizeof(Data));
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    if (*state != NULL)
        ((Instance *)c)->call.freeMemory(*state);
    *state = NULL;
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c;
    (void)state;
    *size = sizeof(Data);
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    if (size < sizeof(Data))
        return wrong(c, "there is no room for a snapshot");
    memcpy(bytes, state, sizeof(Data));
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                                fmi2FMUstate *state)
{
    Instance *one = c;
    if (size != sizeof(Data))
        return wrong(one, "these bytes are no snapshot of this model");
    if (*state == NULL)
        *state = one->call.allocateMemory(1, sizeof(Data));
    if (*state == NULL)
        return wrong(one, "no memory for a snapshot");
    memcpy(*state, bytes, sizeof(Data));
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[], size_t n,
                                                     const fmi2ValueReference known[], size_t m, const fmi2Real dv[],
                                                     fmi2Real du[])
{
    (void)unknown;
    (void)n;
    (void)known;
    (void)m;
    (void)dv;
    (void)du;
    return wrong(c, "there are no directional derivatives");
}

PUBLIC fmi2Status NAME(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                    const fmi2Integer order[], const fmi2Real value[])
{
    (void)vr;
    (void)order;
    (void)value;
    return n == 0 ? fmi2OK : wrong(c, "inputs are held: there are no derivatives of them");
}

PUBLIC fmi2Status NAME(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                     const fmi2Integer order[], fmi2Real value[])
{
    (void)vr;
    (void)order;
    (void)value;
    return n == 0 ? fmi2OK : wrong(c, "outputs are held: there are no derivatives of them");
}

PUBLIC fmi2Status NAME(fmi2DoStep)(fmi2Component c, fmi2Real now, fmi2Real size, fmi2Boolean no_set_prior)
{
    Instance *one = c;
    (void)no_set_prior;
    if (one->data.phase != RUNNING)
        return wrong(one, "a step was asked for outside of the simulation");
    if (!(size >= 0.0 && size <= DBL_MAX) || !(now >= one->data.now - slack(now)) ||
        !(now <= one->data.now + slack(now)))
        return wrong(one, "steps were expected behind each other, none of them backward");
    return advance(one, now + size);
}

PUBLIC fmi2Status NAME(fmi2CancelStep)(fmi2Component c)
{
    return wrong(c, "no step is pending");
}

PUBLIC fmi2Status NAME(fmi2GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)c;
    (void)kind;
    *value = fmi2OK;
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    (void)kind;
    *value = ((Instance *)c)->data.now;
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2GetIntegerStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind;
    (void)value;
    return wrong(c, "there is no such status");
}

PUBLIC fmi2Status NAME(fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)c;
    (void)kind;
    *value = 0;
    return fmi2OK;
}

PUBLIC fmi2Status NAME(fmi2GetStringStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind;
    (void)value;
    return wrong(c, "there is no such status");
}
