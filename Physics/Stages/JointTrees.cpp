#include <Fulcrum/Physics/Stages/JointTrees.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

constexpr uint32_t kNone = JointTreeSlot::kNone;
constexpr uint32_t kMostSlots = 4096;  // bodies: a tree is solved by one worker
// Bodies whose masses differ at most by this factor count as carrying only their own weight.
constexpr float kEvenMasses = 2;
// A lever has at least so many joints one after the other: not the wheels of a car.
constexpr uint32_t kLeastLever = 3;
// Joints that carry only their own bodies are iterated if that takes at most this many times the system's substeps: a
// tree of hinges costs ten to twenty times as much as iterations.
constexpr float kMostSubsteps = 3;

// A set of bodies connected by joints, and a spanning tree of the joints.
struct Component {
    std::span<const uint32_t> bodies;
    uint32_t root = kNone;
    bool anchored = false;       // some joint connects to an immovable body
    bool overridesMass = false;  // some joint overrides masses, which trees do not support
    bool isStrained = false;     // some joint has been strained
    bool isLever = true;         // all joints pass torque on
};

bool HasLocks(const Joint& joint) {
    const JointLocks locks = joint.type->Locks();
    return locks.linear != LinearLock::None || locks.angular != AngularLock::None;
}

// Whether it is a ball joint: only a point lock.
bool IsBall(const Joint& joint) {
    const JointLocks locks = joint.type->Locks();
    return locks.linear == LinearLock::Point && locks.angular == AngularLock::None;
}

class Finder {
public:
    Finder(const BodyStore& bodies, const ConstraintColoring& coloring, const JointStore& joints,
           const SystemSettings& settings, JointTrees& trees, ScratchArena& scratch)
        : bodies_(bodies),
          coloring_(coloring),
          joints_(joints),
          exactLoad_(settings.exactJointLoad),
          errorDivisor_(ErrorDivisorOf(settings.solver)),
          trees_(trees),
          scratch_(scratch),
          slotOf_(scratch.Allocate<uint32_t>(bodies.Size())),
          seen_(scratch.Allocate<uint8_t>(bodies.Size())),
          queue_(scratch.Allocate<uint32_t>(bodies.Size())) {
        std::fill(slotOf_.begin(), slotOf_.end(), kNone);
        std::fill(seen_.begin(), seen_.end(), uint8_t(0));
    }

    void Find() {
        for (int c = 0; c <= ConstraintColoring::kColors; ++c)
            for (const auto& entry : coloring_.At(c).Of(ConstraintColoring::Kind::Joint)) {
                const uint32_t body = entry.fixedA ? entry.bodyB : entry.bodyA;
                if (!seen_[body]) AddTree(ComponentOf(body));
            }
    }

private:
    // Visits (joint, side of `body`) for the participating joints.
    template <class Visit>
    void VisitJoints(uint32_t body, Visit&& visit) const {
        joints_.VisitOf(body, [&](uint32_t index) {
            const Joint& joint = joints_.joints[index];
            if (joint.color.color != 0xFF && joint.color.color != ConstraintColoring::kOverflow && HasLocks(joint))
                visit(index, joint, joint.SideOf(body));
        });
    }
    // Ratio by which iteration errors are smaller than with four substeps of one iteration of each kind.
    static float ErrorDivisorOf(const SolverSettings& solver) {
        const float passes = static_cast<float>(solver.velocityIterations + solver.positionIterations);
        return static_cast<float>(solver.substeps * solver.substeps) * passes / 32;
    }
    float MassOf(uint32_t body) const { return 1.0f / bodies_.dynamics[body].inverseMass; }

    Component ComponentOf(uint32_t first) {
        Component component;
        const size_t begin = queued_;
        queue_[queued_++] = first;
        seen_[first] = 1;
        for (size_t i = begin; i < queued_; ++i) {
            const uint32_t body = queue_[i];
            bool anchored = false;
            VisitJoints(body, [&](uint32_t, const Joint& joint, int side) {
                component.isStrained |= joint.isStrained;
                component.isLever &= joint.type->Locks().angular != AngularLock::None;
                const uint32_t other = joint.body[1 - side];
                anchored |= joint.fixed[1 - side];
                component.overridesMass |= joint.overridesMass;
                if (joint.fixed[1 - side] || seen_[other]) return;
                seen_[other] = 1;
                queue_[queued_++] = other;
            });
            // The root: a body connected to an immovable one, else the heaviest.
            const bool better = component.root == kNone || (anchored && !component.anchored) ||
                                (anchored == component.anchored && !anchored && MassOf(body) > MassOf(component.root));
            if (better) component.root = body;
            component.anchored |= anchored;
        }
        component.bodies = queue_.subspan(begin, queued_ - begin);
        return component;
    }

    void AddTree(const Component& component) {
        if (component.bodies.size() > kMostSlots || component.overridesMass) return;
        for (uint32_t body : component.bodies) {
            const BodyDynamics& d = bodies_.dynamics[body];
            if (d.lockedAxes != LockedAxes::None || d.frozen) return;
        }
        JointTrees::Tree tree;
        tree.slotsBegin = static_cast<uint32_t>(trees_.slots.size());
        tree.blocksBegin = static_cast<uint32_t>(trees_.blocks.size());
        tree.anchorsBegin = static_cast<uint32_t>(trees_.anchors.size());
        size_t links = 0;
        const uint32_t hook = component.anchored ? AddHook(component.root) : kNone;
        if (hook == kNone) AddSlot(component.root, kNone, kNone, false);
        for (uint32_t s = hook == kNone ? 0 : 1; tree.slotsBegin + s < trees_.slots.size(); ++s) {
            const uint32_t body = trees_.slots[tree.slotsBegin + s].body;
            slotOf_[body] = s;
            VisitJoints(body, [&](uint32_t index, const Joint& joint, int side) {
                const uint32_t other = joint.body[1 - side];
                if (index == hook) return;
                ++links;
                if (joint.fixed[1 - side]) {
                    JointTreeAnchor& anchor = trees_.anchors.emplace_back();
                    anchor.slot = s;
                    anchor.joint = index;
                    anchor.isA = side == 0;
                } else if (slotOf_[other] == kNone) {
                    slotOf_[other] = s;  // reserved; its own is set when it is visited
                    AddSlot(other, s, index, side == 1);
                }
            });
        }
        tree.slotsEnd = static_cast<uint32_t>(trees_.slots.size());
        tree.anchorsEnd = static_cast<uint32_t>(trees_.anchors.size());
        // Each joint between two bodies was visited twice, an anchor once.
        const size_t anchors = tree.anchorsEnd - tree.anchorsBegin, joints = (links - anchors) / 2;
        const size_t bodies = tree.slotsEnd - tree.slotsBegin - (hook != kNone);
        const size_t loops = joints - (bodies - 1);
        tree.load = LargestLoad(tree);
        // Bodies that act as one long lever: an iteration resolves little of it. Ball joints would divide it. What is
        // held by several joints is no lever, and a direct solution of it would be no better: of the joints that close
        // a loop iterations undo a part.
        const bool isStrained = component.isStrained && component.isLever && loops + anchors == 0 &&
                                std::isfinite(exactLoad_) && LongestPath(tree) >= kLeastLever;
        // Iterations leave a stretch proportional to the mean load; for a rope that carries only its own weight that is
        // half the load at its top. It decreases with the square of the substeps.
        const bool isRope = LargestMassRatio(tree) <= kEvenMasses;
        float substeps = 0;
        if (isRope) {
            tree.load *= 0.5f;
            substeps = std::sqrt(tree.load / (exactLoad_ * errorDivisor_));
        }
        if (isRope && substeps <= kMostSubsteps && !isStrained) {
            if (substeps > 1) trees_.ropes.push_back({component.root, substeps});
        } else if (loops * 4 <= joints && (tree.load > exactLoad_ || isStrained)) {
            AddBlocks(tree);
            trees_.trees.push_back(tree);
            return;
        }
        trees_.slots.resize(tree.slotsBegin);
        trees_.anchors.resize(tree.anchorsBegin);
    }

    // Adds the joint of the root to the first immovable body; returns the joint.
    uint32_t AddHook(uint32_t root) {
        uint32_t hook = kNone;
        VisitJoints(root, [&](uint32_t index, const Joint& joint, int side) {
            if (hook != kNone || !joint.fixed[1 - side]) return;
            hook = index;
            AddSlot(joint.body[1 - side], kNone, kNone, false);
            trees_.slots.back().fixed = true;
            AddSlot(root, 0, index, side == 0);
        });
        return hook;
    }

    void AddSlot(uint32_t body, uint32_t parent, uint32_t joint, bool isA) {
        JointTreeSlot& slot = trees_.slots.emplace_back();
        slot.body = body;
        slot.parent = parent;
        slot.joint = joint;
        slot.isA = isA;
    }

    // For all dynamic bodies except those on ball joints.
    void AddBlocks(JointTrees::Tree& tree) {
        for (uint32_t s = tree.slotsBegin; s < tree.slotsEnd; ++s) {
            JointTreeSlot& slot = trees_.slots[s];
            if (slot.fixed || (slot.parent != kNone && IsBall(joints_.joints[slot.joint]))) continue;
            slot.block = static_cast<uint32_t>(trees_.blocks.size()) - tree.blocksBegin;
            trees_.blocks.emplace_back();
        }
        tree.blocksEnd = static_cast<uint32_t>(trees_.blocks.size());
    }

    // Ratio of the heaviest body's mass to the lightest one's.
    float LargestMassRatio(const JointTrees::Tree& tree) const {
        float heaviest = 0, lightest = std::numeric_limits<float>::infinity();
        for (uint32_t s = tree.slotsBegin; s < tree.slotsEnd; ++s) {
            if (trees_.slots[s].fixed) continue;
            const float mass = MassOf(trees_.slots[s].body);
            heaviest = std::max(heaviest, mass);
            lightest = std::min(lightest, mass);
        }
        return heaviest / lightest;
    }

    // The number of joints on the longest path from one body to another.
    uint32_t LongestPath(const JointTrees::Tree& tree) const {
        const size_t count = tree.slotsEnd - tree.slotsBegin;
        std::span<uint32_t> height = scratch_.Allocate<uint32_t>(count);
        std::fill(height.begin(), height.end(), 0u);
        uint32_t longest = 0;
        for (size_t s = count; s-- > 1;) {
            const uint32_t parent = trees_.slots[tree.slotsBegin + s].parent;
            longest = std::max(longest, height[parent] + height[s] + 1);
            height[parent] = std::max(height[parent], height[s] + 1);
        }
        return longest;
    }

    float LargestLoad(const JointTrees::Tree& tree) const {
        const size_t count = tree.slotsEnd - tree.slotsBegin;
        std::span<float> load = scratch_.Allocate<float>(count);
        std::fill(load.begin(), load.end(), 0.0f);
        float largest = 0;
        for (size_t s = count; s-- > 0;) {
            const JointTreeSlot& slot = trees_.slots[tree.slotsBegin + s];
            if (slot.parent == kNone) continue;
            const float mass = MassOf(slot.body);
            load[s] += mass;
            load[slot.parent] += load[s];
            largest = std::max(largest, load[s] / mass);
        }
        return largest;
    }

    const BodyStore& bodies_;
    const ConstraintColoring& coloring_;
    const JointStore& joints_;
    float exactLoad_;
    float errorDivisor_;
    JointTrees& trees_;
    ScratchArena& scratch_;
    std::span<uint32_t> slotOf_;  // by body, its slot in the tree
    std::span<uint8_t> seen_;     // by body
    std::span<uint32_t> queue_;   // bodies of the components, each once
    size_t queued_ = 0;
};

}  // namespace

void FindJointTrees(const BodyStore& bodies, const ConstraintColoring& coloring, const JointStore& joints,
                    const SystemSettings& settings, JointTrees& trees, ScratchArena& scratch) {
    if (trees.version == coloring.JointVersion() && trees.strainVersion == joints.strainVersion) return;
    trees.version = coloring.JointVersion();
    trees.strainVersion = joints.strainVersion;
    trees.trees.clear();
    trees.ropes.clear();
    trees.slots.clear();
    trees.blocks.clear();
    trees.anchors.clear();
    Finder(bodies, coloring, joints, settings, trees, scratch).Find();
}

}  // namespace fulcrum
