// The step as a list of verbs, in the order in which PhysicsSystem::Update calls them; each is a file beside this one.
// All run on the thread that steps and schedule their ranges on the world's job system.
#pragma once

#include <Fulcrum/Physics/State/WorldState.h>

namespace fulcrum {

struct StepContext {
    float dt;            // s, of the step, > 0
    float substepDt;     // s
    float impulseScale;  // dt of its substeps / dt of the last step's, at most 2: scales the warm start
};

// Reads poses, velocities, shapes. Writes world inertia and accelerations; fat bounds and trees where a collider left
// its own.
void UpdateBounds(WorldState& world, const StepContext& step);

// World bounds of a collider where its body is now, without any margin.
Bounds TightBoundsOf(const WorldState& world, uint32_t collider);

// Fat bounds of a collider at its body's pose, at rest.
void SetFatBounds(WorldState& world, uint32_t collider);

// Reads trees and the colliders that moved. Adds pairs, sorted by id, and activates resting ones.
void FindPairs(WorldState& world);
// Whether category, mask and group of two bodies let them collide.
bool FiltersAllow(const WorldState& world, uint32_t bodyA, uint32_t bodyB);
// Whether the contact listener, if any, lets them.
bool ListenerAllows(const WorldState& world, uint32_t bodyA, uint32_t bodyB);
// Removes the pairs of a body that its filters no longer allow; their bodies wake.
void RemoveForbiddenPairs(WorldState& world, uint32_t body);
// After the settings got other layerCollides than `before`: removes pairs that these forbid, has those found that they
// allow.
void RefilterLayers(WorldState& world, const std::array<uint32_t, 32>& before);
// Has another listener, or none (null), say what collides; all contacts are as the materials give them until it is
// asked.
void ChangeListener(WorldState& world, const ContactListener* listener);

// Whether contacts between two bodies are wanted,
bool CanCollide(const WorldState& world, uint32_t bodyA, uint32_t bodyB);
// and one of them is awake, and neither disperses while the other is dynamic (Crowd.h).
bool MayCollide(const WorldState& world, uint32_t bodyA, uint32_t bodyB);

struct PairMaterial {
    float friction, restitution;
};
// Of body A, and of body B where it touches with a shape of which `material` is the index into the palette, if there is
// one.
PairMaterial MaterialOfPair(const WorldState& world, uint32_t bodyA, uint32_t bodyB, const Shape& shapeB,
                            uint8_t material);
// Writes that of a pair into its record.
void CombineMaterials(WorldState& world, uint32_t pair);

// Reads active pairs, poses, shapes. Writes manifolds into the records, and which pairs changed. Wakes what is hit.
void Collide(WorldState& world, const StepContext& step);

// Applies the changes: colors contacts that began, uncolors those that ended, removes dead pairs.
void Color(WorldState& world);
// Takes the points from contacts that only a seam between two fixed bodies makes.
void DropGhosts(WorldState& world);
// Whether a joint has a body that is awake and can move.
bool MovesAwake(const WorldState& world, uint32_t joint);
// Gives a pair's contact a color, or takes it away; nothing where it has one, or none.
void ColorPair(WorldState& world, uint32_t pair);
void UncolorPair(WorldState& world, uint32_t pair);
// Uncolors and removes a pair with all its manifolds.
void RemovePair(WorldState& world, uint32_t pair);
// The same for a joint; only one that is enabled and moves awake gets a color.
void ColorJoint(WorldState& world, uint32_t joint);
void UncolorJoint(WorldState& world, uint32_t joint);
// Has the joints of a body see whether it can move: after it was frozen, or revived.
void RecolorJointsOf(WorldState& world, uint32_t body);

// Sorts the colored constraints into the solver's groups and batches, where they changed.
void BuildIslands(WorldState& world);

// Reads records, poses, masses. Writes batches of rows.
void Prepare(WorldState& world, const StepContext& step);

// Substeps: integrates velocities, warm starts, iterates, integrates poses, position passes.
void Solve(WorldState& world, const StepContext& step);

// Bounces what was hit.
void Restitution(WorldState& world, const StepContext& step);

// Writes impulses to the records, displacements to the poses; moves bodies that nothing touched; measures slowness;
// breaks joints.
void Store(WorldState& world, const StepContext& step);

// Casts what moved far and wants it along its way; what hits something bounces there.
void Continuous(WorldState& world, const StepContext& step);

// Finds what is inside the sensors, and what came in or left, all along the ways of the step.
void Sense(WorldState& world, const StepContext& step);

// Puts islands that have been slow for long enough to sleep.
void Sleep(WorldState& world);
// Makes the bodies, all awake, one sleeping island.
void PutToSleep(WorldState& world, std::span<const uint32_t> bodies);
// Puts the island of an awake body to sleep, slow or not.
void SleepIslandOf(WorldState& world, uint32_t body);

}  // namespace fulcrum
