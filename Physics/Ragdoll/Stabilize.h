// Makes a ragdoll's masses and inertias such that a few iterations hold its joints: an iterative solver passes an
// impulse on to the next joint by the ratio of the masses that meet there, so a heavy part on a light one converges
// slowly, and what is light to turn spins up under the impulses of its neighbors. On the settings, once, before the
// ragdoll is created. Source of the idea: O. Strunk, "Stop my Constraints from Blowing Up!", GDC 2013; the rules are
// our own. Any thread.
#pragma once

#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

namespace fulcrum {

// Mass of a part over that of its parent, 0 < smallest <= largest.
struct MassRule {
    float smallest = 0.2f;
    float largest = 1.0f;
};

// From the root to the leaves each part's mass becomes the nearest that obeys the rule; then all are scaled by one
// factor, so that the whole weighs what it did. Inertias scale with the masses. Parts that are not dynamic, and those
// whose parent is not, keep their mass but for that factor. Errors: those of Check; of the rule NonFinite, NonPositive,
// OutOfRange: nothing has changed then.
Status StabilizeMasses(RagdollSettings& settings, const MassRule& rule = {});

struct InertiaRule {
    float principalRatio = 3.0f;  // >= 1: a part's largest principal moment over its smallest
    float childRatio = 1.0f;      // > 0: a part's largest principal moment over its parent's smallest
};

// From the leaves to the root each part's principal moments are raised to what the rule asks for, and no further;
// masses stay. A raised moment turns more slowly under the same torque, nothing else. Parts that are not dynamic are
// passed over. Errors: those of Check; of the rule NonFinite, NonPositive, OutOfRange: nothing has changed then.
Status StabilizeInertia(RagdollSettings& settings, const InertiaRule& rule = {});

// What the body will have, by its settings: kg, and kg m2 about the shape's principal axes. Settings must be valid.
float MassOf(const BodySettings& body);
Vector3 InertiaOf(const BodySettings& body);

}  // namespace fulcrum
