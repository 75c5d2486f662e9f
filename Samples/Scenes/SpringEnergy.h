// The potential energy in the springs of joints, which PhysicsSystem::GetEnergy does not contain. Called by the
// simulation's report and the recorder, between steps; const.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>

namespace fulcrum {

// The sum of k x^2 / 2, J, over all soft limits of enabled joints that are beyond their ends by x: k of the settings,
// or m w^2 with the effective mass m of the row where a frequency was given (SpringSettings.h). Soft limits of linear
// axes and of hinges count. Motors are drives, their springs hold no energy. The effective mass follows from the
// inertia of the shapes: inertia and masses that a user sets otherwise are not known here.
double SpringEnergy(const PhysicsSystem& system);

// GetEnergy, and that of the springs, J.
inline double TotalEnergy(const PhysicsSystem& system) { return system.GetEnergy() + SpringEnergy(system); }

}  // namespace fulcrum
