#include <Fulcrum/Physics/Stages/HardMechanisms.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

constexpr uint32_t kNone = ~0u;
// Bodies whose masses differ at most by this factor count as carrying only their own weight.
constexpr float kEvenMasses = 2;
// A lever has at least so many joints.
constexpr size_t kLeastLever = 3;

bool HasLocks(const Joint& joint) {
    const JointLocks locks = joint.type->Locks();
    return locks.linear != LinearLock::None || locks.angular != AngularLock::None;
}

bool IsDrivenAtStops(const Joint& joint) {
    constexpr JointAxis kAxes[] = {JointAxis::LinearX,  JointAxis::LinearY,  JointAxis::LinearZ,
                                   JointAxis::AngularX, JointAxis::AngularY, JointAxis::AngularZ};
    return std::ranges::any_of(kAxes, [&](JointAxis axis) {
        const AxisControl* control = joint.type->Control(axis);
        return control && IsDrivenAtStops(*control);
    });
}

class Finder {
public:
    Finder(const BodyStore& bodies, const ConstraintColoring& coloring, const JointStore& joints,
           const SystemSettings& settings, HardMechanisms& found, ScratchArena& scratch)
        : bodies_(bodies),
          coloring_(coloring),
          joints_(joints),
          exactLoad_(settings.exactJointLoad),
          errorDivisor_(ErrorDivisorOf(settings.solver)),
          found_(found),
          queue_(scratch.Allocate<uint32_t>(bodies.Size())),
          parents_(scratch.Allocate<uint32_t>(bodies.Size())),
          placeOf_(scratch.Allocate<uint32_t>(bodies.Size())),
          loads_(scratch.Allocate<float>(bodies.Size())) {
        std::ranges::fill(placeOf_, kNone);
    }

    void Find() {
        for (int c = 0; c <= ConstraintColoring::kColors; ++c)
            for (const auto& entry : coloring_.At(c).Of(ConstraintColoring::Kind::Joint)) {
                const uint32_t body = entry.fixedA ? entry.bodyB : entry.bodyA;
                if (placeOf_[body] == kNone) Add(body);
            }
    }

private:
    // Visits (joint, side of `body`) for the participating joints.
    template <class Visit>
    void VisitJoints(uint32_t body, Visit&& visit) const {
        joints_.VisitOf(body, [&](uint32_t index) {
            const Joint& joint = joints_.joints[index];
            if (joint.color.color != 0xFF && joint.color.color != ConstraintColoring::kOverflow && HasLocks(joint))
                visit(joint, joint.SideOf(body));
        });
    }
    // Ratio by which iteration errors are smaller than with four substeps of one iteration of each kind.
    static float ErrorDivisorOf(const SolverSettings& solver) {
        const float passes = static_cast<float>(solver.velocityIterations + solver.positionIterations);
        return static_cast<float>(solver.substeps * solver.substeps) * passes / 32;
    }
    bool IsHeld(uint32_t body) const {
        const BodyDynamics& d = bodies_.dynamics[body];
        return d.lockedAxes != LockedAxes::None || d.frozen;
    }
    float MassOf(uint32_t body) const { return 1.0f / bodies_.dynamics[body].inverseMass; }

    // Visits all bodies that joints connect to this one.
    void Add(uint32_t first) {
        const size_t begin = queued_;
        bool isStrained = false, isPastLimit = false, isBeyondTarget = false, isIterated = false;
        bool isLever = true;            // all joints pass torque on
        bool isDriven = false;          // by a motor, at a stop
        size_t links = 0, anchors = 0;  // joints with other bodies, each counted twice, and with immovable ones
        // The root: a body connected to an immovable one, else the heaviest.
        uint32_t root = first;
        bool isAnchored = false;
        const auto visit = [&](uint32_t from, auto&& note) {
            queue_[begin] = from;
            parents_[begin] = kNone;
            placeOf_[from] = static_cast<uint32_t>(begin);
            queued_ = begin + 1;
            for (size_t i = begin; i < queued_; ++i)
                VisitJoints(queue_[i], [&](const Joint& joint, int side) {
                    note(queue_[i], joint, side);
                    const uint32_t other = joint.body[1 - side];
                    if (joint.fixed[1 - side] || placeOf_[other] != kNone) return;
                    placeOf_[other] = static_cast<uint32_t>(queued_);
                    parents_[queued_] = static_cast<uint32_t>(i);
                    queue_[queued_++] = other;
                });
        };
        visit(first, [&](uint32_t body, const Joint& joint, int side) {
            const bool isFixed = joint.fixed[1 - side];
            isStrained |= joint.isStrained;
            isPastLimit |= joint.wasPastLimit;
            isBeyondTarget |= joint.isBeyondTarget;
            isLever &= joint.type->Locks().angular != AngularLock::None;
            isIterated |= joint.overridesMass || joint.priority != JointPriority::Normal || IsHeld(body);
            ++(isFixed ? anchors : links);
            isDriven |= IsDrivenAtStops(joint);
            const bool isHeavier = !isAnchored && MassOf(body) > MassOf(root);
            if (isFixed ? !isAnchored : isHeavier) root = body;
            isAnchored |= isFixed;
        });
        // A direct solution knows neither of masses that differ by joint, nor of joints that win over others. Of bodies
        // with locked axes piles gained energy.
        if (isIterated || !std::isfinite(exactLoad_)) return;
        const size_t count = queued_ - begin;
        const bool hasLoop = links / 2 + anchors > count - 1 + (anchors > 0);
        if (hasLoop || isPastLimit) found_.contradicting.push_back(first);
        if (hasLoop) return;
        if (isBeyondTarget) return found_.open.push_back(first);
        // Bodies that act as one long lever: an iteration resolves little of it. Ball joints would divide it.
        if (isStrained && isLever && count > kLeastLever) return found_.open.push_back(first);
        // A motor takes any impulse that its speed needs, and iterations pass it on to the other joints one by one:
        // they give way, and so does the stop.
        if (isDriven && links / 2 + anchors > 1) return found_.open.push_back(first);
        for (size_t i = begin; i < queued_; ++i) placeOf_[queue_[i]] = kNone;
        visit(root, [](uint32_t, const Joint&, int) {});
        // Iterations leave a stretch proportional to the mean load; for a rope that carries only its own weight that is
        // half the load at its top, and decreases with the square of the substeps.
        float heaviest = 0, lightest = std::numeric_limits<float>::infinity();
        for (size_t i = begin; i < queued_; ++i) {
            heaviest = std::max(heaviest, MassOf(queue_[i]));
            lightest = std::min(lightest, MassOf(queue_[i]));
        }
        const float load = LargestLoad(begin);
        const bool isRope = heaviest <= kEvenMasses * lightest;
        if (isRope ? 0.5f * load > exactLoad_ * errorDivisor_ : load > exactLoad_) found_.open.push_back(first);
    }

    // The largest ratio of the mass of a body and those behind it to its own.
    float LargestLoad(size_t begin) {
        for (size_t i = begin; i < queued_; ++i) loads_[i] = 0;
        float largest = 0;
        for (size_t i = queued_; i-- > begin;) {
            const float mass = MassOf(queue_[i]);
            loads_[i] += mass;
            largest = std::max(largest, loads_[i] / mass);
            if (parents_[i] != kNone) loads_[parents_[i]] += loads_[i];
        }
        return largest;
    }

    const BodyStore& bodies_;
    const ConstraintColoring& coloring_;
    const JointStore& joints_;
    float exactLoad_;
    float errorDivisor_;
    HardMechanisms& found_;
    // Bodies of the mechanisms, each once, those behind others later, and the places of those before them.
    std::span<uint32_t> queue_, parents_;
    std::span<uint32_t> placeOf_;  // by body
    std::span<float> loads_;       // by place
    size_t queued_ = 0;
};

}  // namespace

void FindHardMechanisms(const BodyStore& bodies, const ConstraintColoring& coloring, const JointStore& joints,
                        const SystemSettings& settings, HardMechanisms& found, ScratchArena& scratch) {
    if (found.version == coloring.JointVersion() && found.strainVersion == joints.strainVersion) return;
    found.version = coloring.JointVersion();
    found.strainVersion = joints.strainVersion;
    found.open.clear();
    found.contradicting.clear();
    Finder(bodies, coloring, joints, settings, found, scratch).Find();
}

}  // namespace fulcrum
