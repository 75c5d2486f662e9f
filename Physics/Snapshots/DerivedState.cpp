// Recomputes derived state, which is not stored in snapshots.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeBulk.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Physics/Snapshots/SnapshotAccess.h>
#include <Fulcrum/Physics/World/BodyColliders.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/ShapeEdits.h>

#include <algorithm>

namespace fulcrum {

void SnapshotAccess::Resize(BodyStore& bodies, uint32_t count) {
    bodies.states.resize(count);
    bodies.masses.resize(count);
    bodies.poses.resize(count);
    bodies.unconstrained.resize(count);
    bodies.dynamics.resize(count);
    bodies.cold.resize(count);
    bodies.remainders.resize(count);
    bodies.slowMotions.resize(count);
}

void SnapshotAccess::Resize(ColliderStore& colliders, uint32_t count) {
    for (uint32_t i = count; i < colliders.colliders.size(); ++i)
        for (BoundsTree* tree : {&colliders.staticTree, &colliders.movingTree, &colliders.sensorTree})
            if (tree->Contains(i)) tree->Remove(i);
    colliders.colliders.resize(count);
    colliders.shapes.resize(count);
}

void SnapshotAccess::Resize(PairStore& pairs, uint32_t count) {
    for (uint32_t i = count; i < pairs.pairs.size(); ++i)
        if (const PairPlace place = PlaceOf(pairs.pairs[i]); place.isInTable) pairs.RemoveKey(place.Key(), i);
    // While pairs are read the table also contains the previous ones.
    if (size_t places = std::max<size_t>(pairs.table_.size(), 1024);
        2 * size_t{count} > places || pairs.table_.empty()) {
        while (2 * size_t{count} > places) places *= 2;
        for (Pair& pair : pairs.pairs) pair.exists = false;
        pairs.table_.assign(places, PairStore::kNone);
    }
    pairs.pairs.resize(count);
    pairs.loads.resize(count);
    pairs.links_.resize(count);
    pairs.contacts.clear();
    pairs.records.clear();
    pairs.massOverrides.clear();
    pairs.surfaceVelocities.clear();
    pairs.freeContact_ = PairStore::kNone;
    pairs.freeContacts_ = 0;
    pairs.reported.resize(pairs.keepsReported_ ? count : 0);
    pairs.active.words_.assign((count + 63) / 64, 0);
    pairs.active.size_ = 0;
}

void SnapshotAccess::Resize(JointStore& joints, uint32_t count) {
    joints.records.resize(count);
    joints.types.resize(count);
    joints.joints.resize(count);
    joints.breakable.words_.assign((count + 63) / 64, 0);
    joints.breakable.size_ = 0;
}

void SnapshotAccess::FindAwakePlaces(BodyStore& bodies) {
    for (uint32_t place = 0; place < bodies.awake.size(); ++place) bodies.cold[bodies.awake[place]].awakePlace = place;
    bodies.CountPlacedAsleep();
}

void SnapshotAccess::ListSpecial(BodyStore& bodies) {
    bodies.worldBody = BodyStore::kNone;
    for (IndexSet* set : {&bodies.pushed, &bodies.singleMoves, &bodies.editable}) {
        set->words_.assign((bodies.cold.size() + 63) / 64, 0);
        set->size_ = 0;
    }
    for (uint32_t i = 0; i < bodies.Size(); ++i) {
        const BodyCold& body = bodies.cold[i];
        if (!body.exists) continue;
        if (bodies.dynamics[i].hasForce || !body.lastPush.IsZero()) bodies.pushed.Insert(i);
        if (body.singleMove != SingleMove::None) bodies.singleMoves.Insert(i);
        if (IsEditable(*body.shape)) bodies.editable.Insert(i);
        if (body.isWorld) bodies.worldBody = i;
    }
}

bool SnapshotAccess::AttachPieces(const BodyStore& bodies, ColliderStore& store) {
    store.shapes.assign(store.shapes.size(), {});
    bool areSame = true;
    for (uint32_t body = 0; body < bodies.Size(); ++body) {
        const BodyCold& cold = bodies.cold[body];
        if (!cold.exists && !cold.removed) continue;
        const auto* compound = cold.shape->IsCompound() ? static_cast<const CompoundShape*>(cold.shape.get()) : nullptr;
        uint32_t child = 0;
        const auto attachRun = [&](uint32_t first, uint32_t count) {
            for (uint32_t i = first; i < first + count; ++i, ++child) {
                areSame &= store.colliders[i].body == body;
                store.colliders[i].body = body;
                if (!compound) store.shapes[i].shape = cold.shape.get();
                else if (child < compound->Children().size())
                    store.shapes[i] = PieceOfChild(*compound, compound->ChildAt(child));
            }
        };
        attachRun(cold.firstCollider, cold.colliderCount);
        for (uint32_t run = cold.MoreColliders(); run != ColliderStore::kNone; run = store.runs[run].next)
            attachRun(store.runs[run].first, store.runs[run].count);
    }
    return areSame;
}

void SnapshotAccess::ListMoved(ColliderStore& colliders) {
    colliders.moved.clear();
    for (uint32_t i = 0; i < colliders.colliders.size(); ++i)
        if (colliders.colliders[i].queued) colliders.moved.push_back(i);
}

void SnapshotAccess::UpdateTrees(const BodyStore& bodies, ColliderStore& store) {
    uint32_t moved = 0;
    for (uint32_t i = 0; i < store.colliders.size(); ++i) {
        const Collider& collider = store.colliders[i];
        const bool isThere = store.shapes[i].shape && bodies.cold[collider.body].exists;
        const BoundsTree* own = isThere ? &store.TreeOf(collider) : nullptr;
        for (BoundsTree* tree : {&store.staticTree, &store.movingTree, &store.sensorTree}) {
            const bool has = tree->Contains(i);
            if (tree != own) {
                if (has) tree->Remove(i);
            } else if (!has) {
                tree->Insert(i, collider.fat);
            } else if (tree == &store.movingTree) {
                ++moved;
            } else {
                const Bounds bounds = tree->GetBounds(i);
                if (!bounds.Contains(collider.fat) || !collider.fat.Contains(bounds)) tree->Update(i, collider.fat);
            }
        }
    }
    if (moved > 0) {
        store.movingTree.UpdateLeaves(0, store.movingTree.NodeCount(),
                                      [&](uint32_t i) -> const Bounds& { return store.colliders[i].fat; });
        store.movingTree.NoteUpdated(moved);
    }
    for (BoundsTree* tree : {&store.staticTree, &store.movingTree, &store.sensorTree}) tree->Optimize();
}

void SnapshotAccess::ClearColors(uint32_t bodies, ConstraintColoring& coloring) {
    for (ConstraintColoring::Color& color : coloring.colors_)
        for (Array<ConstraintColoring::Entry>& list : color.lists) list.clear();
    coloring.postponed_.clear();
    coloring.ReserveBodies(bodies);
    std::ranges::fill(coloring.used_, uint64_t{0});
    std::ranges::fill(coloring.overflows_, 0u);
    coloring.size_ = 0;
}

}  // namespace fulcrum
