// The solver loop as a sequence of short parallel phases: one per colour, iteration and substep, and two over the bodies per
// substep. Colours come in ascending order, contacts that fitted no colour after them, one by one.
//
// Only bodies that a contact touches take part; the others are moved by Store, in one go.
//
// The warm start of every substep but the first costs nothing per contact: within a step the rows do not change, so the
// impulses of the last substep give each body the same change of velocity again, and that is its velocity at the substep's
// end minus what it was without constraints.
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Jobs/Phases.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>

namespace fulcrum {

namespace {

constexpr uint32_t kBatchesPerBlock = 4;
constexpr uint32_t kBodiesPerBlock = 128;

enum class Verb : uint8_t { IntegrateVelocities, WarmStart, Velocities, IntegratePoses, Positions, Separations, Restitution };

struct Phase {
    Verb verb;
    uint8_t substep;
    uint16_t colour;  // index into SolverGroup::colours; the number of colours means the overflow
};

// Velocity that a body has after h seconds of damping 1/s, per unit: exp(-damping h).
float DampingFactor(float damping, float h) { return damping > 0 ? Exp(-damping * h) : 1.0f; }

// Batches are streamed: the next one is on its way while this one is solved.
template <class Batch>
[[gnu::always_inline]] inline void Prefetch(const Batch& batch) {
    const char* bytes = reinterpret_cast<const char*>(&batch);
    for (size_t line = 0; line < offsetof(Batch, bounceSpeed); line += 64) __builtin_prefetch(bytes + line);
}

bool ClampLength(Vector3& v, float limit) {
    const float squared = LengthSquared(v);
    if (squared <= limit * limit) return false;
    v *= limit / std::sqrt(squared);
    return true;
}

class StepSolver {
public:
    StepSolver(WorldState& world, const StepContext& step) : world_(world), h_(step.substepDt) {
        settings_.inverseDt = 1.0f / h_;
        settings_.baumgarte = world.settings.baumgarte;
        settings_.slop = world.settings.penetrationSlop;
        settings_.maxCorrection = world.settings.maxPositionCorrection;
        settings_.elapsed = 0;
    }

    void Run(std::span<const Phase> phases) {
        std::span<uint32_t> counts = world_.scratch.Allocate<uint32_t>(phases.size());
        for (size_t i = 0; i < phases.size(); ++i) counts[i] = BlockCount(phases[i]);
        RunPhases(*world_.jobs, counts, [&](uint32_t phase, uint32_t block, uint32_t worker) {
            RunBlock(phases[phase], block, worker);
        });
    }

private:
    uint32_t BlockCount(const Phase& phase) const {
        if (phase.verb == Verb::IntegrateVelocities || phase.verb == Verb::IntegratePoses)
            return (static_cast<uint32_t>(world_.bodies.awake.size()) + kBodiesPerBlock - 1) / kBodiesPerBlock;
        if (phase.colour == world_.group.colours.size()) return 1;
        const SolverGroup::ColourRange& range = world_.group.colours[phase.colour];
        const uint32_t batches = range.movingEnd - range.movingBegin + range.fixedEnd - range.fixedBegin;
        return (batches + kBatchesPerBlock - 1) / kBatchesPerBlock;
    }

    void RunBlock(const Phase& phase, uint32_t block, uint32_t worker) {
        if (phase.verb == Verb::IntegrateVelocities || phase.verb == Verb::IntegratePoses) {
            const uint32_t end = std::min((block + 1) * kBodiesPerBlock, static_cast<uint32_t>(world_.bodies.awake.size()));
            for (uint32_t i = block * kBodiesPerBlock; i < end; ++i) {
                const uint32_t body = world_.bodies.awake[i];
                if (!world_.colouring.IsTouched(body)) continue;
                if (phase.verb == Verb::IntegratePoses) IntegratePose(body);
                else IntegrateVelocity(body, phase.substep > 0, world_.findings[worker]);
            }
            return;
        }
        SolverGroup& group = world_.group;
        if (phase.colour == group.colours.size()) {
            for (auto& batch : group.overflowMoving) RunBatch(phase, batch);
            for (auto& batch : group.overflowFixed) RunBatch(phase, batch);
            return;
        }
        const SolverGroup::ColourRange& range = group.colours[phase.colour];
        const uint32_t moving = range.movingEnd - range.movingBegin;
        const uint32_t all = moving + range.fixedEnd - range.fixedBegin;
        const uint32_t end = std::min((block + 1) * kBatchesPerBlock, all);
        for (uint32_t i = block * kBatchesPerBlock; i < end; ++i) {
            if (i < moving) {
                if (i + 1 < moving) Prefetch(group.moving[range.movingBegin + i + 1]);
                RunBatch(phase, group.moving[range.movingBegin + i]);
            }
            else RunBatch(phase, group.fixed[range.fixedBegin + i - moving]);
        }
    }

    template <class Batch>
    void RunBatch(const Phase& phase, Batch& batch) {
        BodyState* states = world_.bodies.states.data();
        switch (phase.verb) {
            case Verb::WarmStart: WarmStartContacts(batch, states); break;
            case Verb::Velocities: SolveContactVelocities(batch, states, settings_); break;
            case Verb::Restitution: RestituteContacts(batch, states); break;
            case Verb::Positions:
            case Verb::Separations: {
                ContactSolveSettings settings = settings_;
                if (phase.verb == Verb::Separations) settings.baumgarte = 0;
                settings.elapsed = h_ * static_cast<float>(phase.substep + 1);
                SolveContactPositions(batch, states, settings);
                break;
            }
            case Verb::IntegrateVelocities:
            case Verb::IntegratePoses: break;
        }
    }

    void IntegrateVelocity(uint32_t body, bool again, WorkerFindings& findings) {
        BodyStore& bodies = world_.bodies;
        const BodyDynamics& d = bodies.dynamics[body];
        if (d.motion != MotionType::Dynamic) return;
        const float* a = bodies.poses[body].acceleration;
        float* unconstrained = bodies.unconstrained[body].row;
        float* row = bodies.states[body].VelocityRow();
        Vector3 v(row[0], row[1], row[2]), w(row[3], row[4], row[5]);
        Vector3 carryV = Vector3::Zero(), carryW = Vector3::Zero();
        if (again) {
            carryV = v - Vector3(unconstrained[0], unconstrained[1], unconstrained[2]);
            carryW = w - Vector3(unconstrained[3], unconstrained[4], unconstrained[5]);
        }
        v = (v + Vector3(a[0], a[1], a[2]) * h_) * DampingFactor(d.linearDamping, h_);
        w *= DampingFactor(d.angularDamping, h_);
        if (d.hasForce) {
            const float* i = bodies.masses[body].inverseInertia;
            w += SymmetricMatrix3{i[0], i[1], i[2], i[3], i[4], i[5]} * bodies.cold[body].torque * h_;
        }
        if (static_cast<uint8_t>(d.lockedAxes) & 7)
            for (int k = 0; k < 3; ++k)
                if (static_cast<uint8_t>(d.lockedAxes) >> k & 1) v[k] = carryV[k] = 0;
        const bool fast = ClampLength(v, d.maxLinearSpeed) | ClampLength(w, d.maxAngularSpeed);
        findings.clamped += fast;
        for (int k = 0; k < 3; ++k) {
            unconstrained[k] = v[k];
            unconstrained[3 + k] = w[k];
            row[k] = v[k] + carryV[k];
            row[3 + k] = w[k] + carryW[k];
        }
    }

    void IntegratePose(uint32_t body) {
        const BodyDynamics& d = world_.bodies.dynamics[body];
        if (d.motion != MotionType::Dynamic) return;
        BodyState& s = world_.bodies.states[body];
        if (static_cast<uint8_t>(d.lockedAxes) & 7)
            for (int k = 0; k < 3; ++k)
                if (static_cast<uint8_t>(d.lockedAxes) >> k & 1) s.linearVelocity[k] = 0;
        for (int k = 0; k < 3; ++k) {
            s.deltaPosition[k] += s.linearVelocity[k] * h_;
            s.deltaRotation[k] += s.angularVelocity[k] * h_;
        }
    }

    WorldState& world_;
    float h_;
    ContactSolveSettings settings_;
};

// Appends the phases of one verb: its colours, then the overflow.
void AppendColours(const WorldState& world, Verb verb, int substep, std::span<Phase> phases, size_t& count) {
    const size_t colours = world.group.colours.size() + (world.report.overflowContacts > 0 ? 1 : 0);
    for (size_t c = 0; c < colours; ++c)
        phases[count++] = {verb, static_cast<uint8_t>(substep), static_cast<uint16_t>(c)};
}

}  // namespace

void Solve(WorldState& world, const StepContext& step) {
    if (world.colouring.Size() == 0) return;
    const SolverSettings& settings = world.group.settings;
    const size_t perVerb = world.group.colours.size() + 1;
    const size_t passes = static_cast<size_t>(settings.velocityIterations + settings.positionIterations + 2);
    std::span<Phase> phases = world.scratch.Allocate<Phase>(static_cast<size_t>(settings.substeps) * (passes * perVerb + 2) + perVerb);
    size_t count = 0;
    for (int substep = 0; substep < settings.substeps; ++substep) {
        const uint8_t s = static_cast<uint8_t>(substep);
        phases[count++] = {Verb::IntegrateVelocities, s, 0};
        if (substep == 0) AppendColours(world, Verb::WarmStart, substep, phases, count);
        for (int i = 0; i < settings.velocityIterations; ++i) AppendColours(world, Verb::Velocities, substep, phases, count);
        phases[count++] = {Verb::IntegratePoses, s, 0};
        for (int i = 0; i < settings.positionIterations; ++i) AppendColours(world, Verb::Positions, substep, phases, count);
        // The next substep must know how far apart the points are, whether or not anything pushes them apart.
        if (settings.positionIterations == 0) AppendColours(world, Verb::Separations, substep, phases, count);
    }
    StepSolver(world, step).Run(phases.first(count));
}

void Restitution(WorldState& world) {
    if (!world.bounces) return;
    std::span<Phase> phases = world.scratch.Allocate<Phase>(world.group.colours.size() + 1);
    size_t count = 0;
    AppendColours(world, Verb::Restitution, 0, phases, count);
    StepSolver(world, {1.0f, 1.0f}).Run(phases.first(count));
}

}  // namespace fulcrum
