// Carries the precompiled headers that the rooms share (FasciaRoom.cmake).
