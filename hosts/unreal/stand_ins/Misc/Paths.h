#pragma once
#include "CoreMinimal.h"
struct FPaths {
  static FString ProjectContentDir() { return {}; }
  static FString ConvertRelativePathToFull(const FString&, const FString&) { return {}; }
};
