#include <Fulcrum/Physics/World/Lifts.h>

#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/Filters.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/ReserveMore.h>
#include <Fulcrum/Physics/World/Teleports.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <algorithm>
#include <utility>

namespace fulcrum {

namespace {

// One edit of one field.
class EditLift {
public:
    EditLift(WorldState& world, uint32_t collider, uint64_t version)
        : world_(world),
          store_(world.lifts),
          field_(static_cast<const HeightField&>(*world.colliders.shapes[collider].shape)),
          collider_(collider),
          version_(version),
          frame_(ColliderPoseOf(world.bodies, world.colliders, collider)),
          up_(Rotate(frame_.rotation, Vector3(0, 1, 0))) {}

    void Run(std::span<const uint32_t> near) {
        for (size_t i = 0; i < near.size(); ++i)
            if (i == 0 || near[i] != near[i - 1]) Raise(near[i], LiftFromGround(near[i]));
        // Until all have followed: the result is the same in whichever order they do.
        for (bool hasSpread = true; hasSpread;) {
            hasSpread = false;
            for (size_t i = 0; i < store_.listed.size(); ++i) {
                LiftStore::Body& body = store_.bodies[store_.listed[i]];
                if (!(body.lift > body.spread)) continue;
                body.spread = body.lift;
                hasSpread = true;
                Spread(store_.listed[i], body.lift);
            }
        }
        std::erase_if(store_.listed, [&](uint32_t body) {
            const bool stays = !(store_.bodies[body].lift > 0);
            if (stays) store_.bodies[body] = {};
            return stays;
        });
        std::sort(store_.listed.begin(), store_.listed.end());
        Teleport(world_, store_.listed, [&](uint32_t body) {
            return world_.bodies.dynamics[body].AlongFreeTranslations(up_ * store_.bodies[body].lift);
        });
        for (const uint32_t body : store_.listed) store_.bodies[body] = {};
        store_.listed.clear();
    }

private:
    // A convex piece of a body in the frame of the field.
    struct Piece {
        Vector3 center;
        Bounds bounds;
    };
    template <class Visit>
    void VisitPieces(uint32_t body, Visit&& visit) const {
        VisitColliders(world_, body, [&](uint32_t index) {
            if (world_.colliders.shapes[index].shape->IsConvex() && !world_.colliders.colliders[index].sensor)
                visit(index, PieceAt(index));
        });
    }
    Piece PieceAt(uint32_t index) const {
        const auto& shape = static_cast<const ConvexShape&>(*world_.colliders.shapes[index].shape);
        const RelativePose pose = Relative(frame_, ColliderPoseOf(world_.bodies, world_.colliders, index));
        Piece piece{pose.position, {}};
        for (int axis = 0; axis < 3; ++axis) {
            Vector3 along = Vector3::Zero();
            along[axis] = 1;
            const Vector3 local = InverseRotate(pose.rotation, along);
            piece.bounds.upper[axis] = pose.position[axis] + Dot(local, shape.Support(local));
            piece.bounds.lower[axis] = pose.position[axis] + Dot(local, shape.Support(Vector3(-local)));
        }
        return piece;
    }

    // m; 0: it stays.
    float LiftFromGround(uint32_t body) const {
        const uint32_t ground = world_.colliders.colliders[collider_].body;
        if (!world_.bodies.CanMove(body) || !CanCollide(world_.settings, world_.bodies, world_.joints, ground, body))
            return 0;
        float lift = 0;
        VisitPieces(body, [&](uint32_t index, const Piece& piece) {
            const auto [before, after] = field_.ChangeOf(version_, piece.center.x(), piece.center.z());
            const float rise = after - std::max(before, piece.bounds.lower.y());
            if (!(after > before && rise > lift)) return;
            if (!field_.HadTriangles(version_, piece.bounds)) return;
            if (piece.center.y() >= before || IsTouchedBy(index)) lift = rise;
        });
        if (lift > 0 && !HasPair(body) && !ListenerAllows(world_.listener, world_.bodies, ground, body)) return 0;
        return lift;
    }
    // Thin bodies at rest may have their centers below the surface. A field with two sides may be touched from below.
    bool IsTouchedBy(uint32_t index) const {
        const uint32_t pair = field_.IsTwoSided() ? PairStore::kNone : world_.pairs.Find(collider_, index);
        return pair != PairStore::kNone && world_.pairs.pairs[pair].touching;
    }
    bool HasPair(uint32_t body) const {
        bool hasPair = false;
        VisitColliders(world_, body,
                       [&](uint32_t index) { hasPair |= world_.pairs.Find(collider_, index) != PairStore::kNone; });
        return hasPair;
    }

    void Raise(uint32_t body, float lift) {
        if (!(lift > store_.bodies[body].lift) || !MayLift(body)) return;
        List(body);
        store_.bodies[body].lift = lift;
    }
    void List(uint32_t body) {
        if (!std::exchange(store_.bodies[body].isListed, true)) store_.listed.push_back(body);
    }
    // Whether nothing holds its mechanism at a point. Asked once of each mechanism.
    bool MayLift(uint32_t body) {
        using Mechanism = LiftStore::Mechanism;
        if (store_.bodies[body].mechanism == Mechanism::Unknown) {
            Array<uint32_t>& members = store_.mechanism;
            members.clear();
            const auto add = [&](uint32_t member) {
                if (store_.bodies[member].mechanism != Mechanism::Unknown) return;
                store_.bodies[member].mechanism = Mechanism::Free;
                List(member);
                members.push_back(member);
            };
            add(body);
            bool isHeld = false;
            for (size_t i = 0; i < members.size(); ++i)
                VisitJoined(members[i], [&](uint32_t other, const Joint& joint) {
                    if (world_.bodies.CanMove(other)) add(other);
                    else isHeld |= joint.locks.linear == LinearLock::Point;
                });
            if (isHeld)
                for (const uint32_t member : members) store_.bodies[member].mechanism = Mechanism::Held;
        }
        return store_.bodies[body].mechanism == Mechanism::Free;
    }
    template <class Visit>
    void VisitJoined(uint32_t body, Visit&& visit) const {
        world_.joints.VisitOf(body, [&](uint32_t index) {
            const Joint& joint = world_.joints.joints[index];
            if (joint.enabled) visit(joint.body[1 - joint.SideOf(body)], joint);
        });
    }

    void Spread(uint32_t body, float lift) {
        VisitJoined(body, [&](uint32_t other, const Joint&) {
            if (world_.bodies.CanMove(other)) Raise(other, lift);
        });
        VisitPieces(body, [&](uint32_t index, const Piece& piece) {
            const Bounds swept = BoundsAlong(TightBoundsOf(world_.bodies, world_.colliders, index), up_ * lift, 0);
            world_.colliders.movingTree.Query(swept, [&](uint32_t found) {
                const Collider& collider = world_.colliders.colliders[found];
                if (collider.sensor || !world_.bodies.CanMove(collider.body) ||
                    !world_.colliders.shapes[found].shape->IsConvex() ||
                    !CanCollide(world_.settings, world_.bodies, world_.joints, body, collider.body))
                    return;
                const Piece above = PieceAt(found);
                if (LiesOn(above, piece))
                    Raise(collider.body, lift - std::max(above.bounds.lower.y() - piece.bounds.upper.y(), 0.0f));
            });
        });
    }
    static bool LiesOn(const Piece& a, const Piece& b) {
        return a.bounds.lower.y() >= b.center.y() && a.bounds.lower.x() <= b.bounds.upper.x() &&
               b.bounds.lower.x() <= a.bounds.upper.x() && a.bounds.lower.z() <= b.bounds.upper.z() &&
               b.bounds.lower.z() <= a.bounds.upper.z();
    }

    WorldState& world_;
    LiftStore& store_;
    const HeightField& field_;
    uint32_t collider_;
    uint64_t version_;
    Pose frame_;
    Vector3 up_;
};

}  // namespace

size_t HeapBytes(const LiftStore& store) {
    const auto& [bodies, listed, mechanism] = store;
    return HeapBytes(bodies, listed, mechanism);
}

void ReserveLifts(WorldState& world) {
    if (world.bodies.editable.Size() == 0) return;
    LiftStore& store = world.lifts;
    const size_t count = world.bodies.Size();
    if (!store.listed.empty()) {  // an exception of the contact listener ended the last
        store.bodies.clear();
        store.listed.clear();
    }
    ReserveRoom(store.listed, count);
    ReserveRoom(store.mechanism, count);
    ReserveRoom(store.bodies, count);
    store.bodies.resize(count);
}

void LiftByEdit(WorldState& world, uint32_t collider, uint64_t version, std::span<const uint32_t> near) {
    EditLift(world, collider, version).Run(near);
}

}  // namespace fulcrum
