using System.IO;
using UnrealBuildTool;

public class Fascia : ModuleRules
{
    public Fascia(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
        PublicDependencyModuleNames.AddRange(new[] { "Core", "CoreUObject", "Engine", "ProceduralMeshComponent" });
        // `cmake --install build --prefix ThirdParty` puts the header and the library here.
        string third = Path.Combine(PluginDirectory, "ThirdParty");
        PublicSystemIncludePaths.Add(Path.Combine(third, "include"));
        bool windows = Target.Platform == UnrealTargetPlatform.Win64;
        string library = windows ? "fascia.dll" : Target.Platform == UnrealTargetPlatform.Mac ? "libfascia.dylib" : "libfascia.so";
        PublicAdditionalLibraries.Add(Path.Combine(third, "lib", windows ? "fascia.lib" : library));
        RuntimeDependencies.Add("$(BinaryOutputDir)/" + library, Path.Combine(third, windows ? "bin" : "lib", library));
    }
}
