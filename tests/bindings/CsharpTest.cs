// The C# binding on a rig: mono CsharpTest.exe RIG.glb
using System;
using System.IO;
using System.Text;

static class CsharpTest
{
    static void Expect(bool condition, string what)
    {
        if (!condition) throw new Exception("failed: " + what);
    }

    static unsafe int Main(string[] arguments)
    {
        byte[] bytes = File.ReadAllBytes(arguments[0]);
        using (var asset = Fascia.Asset.Load(bytes))
        using (var face = new Fascia.Face(asset, Fascia.Space.Metres))
        {
            int muscle = Array.FindIndex(asset.Channels, channel => channel.Group == "muscle");
            Expect(muscle >= 0 && asset.Channels[muscle].Maximum == 1, "a muscle's channel");
            int skin = 0;
            for (int i = 0; i < asset.Meshes.Length; ++i)
                if (asset.Meshes[i].Part == "skin") skin = i;
            int count = asset.Meshes[skin].VertexCount;
            var rest = new float[3 * count];
            var posed = new float[3 * count];
            var normals = new float[3 * count];
            face.WritePositions(skin, rest);
            face.Set(asset.Channels[muscle].Name, 0.7f);
            Expect(face.Values[muscle] == 0.7f, "set by name");
            for (int i = 0; i < asset.Channels.Length; ++i)
                if (asset.Channels[i].Group == "muscle") face.Values[i] = 0.3f;
            face.Pose();
            face.WritePositions(skin, posed);
            face.WriteNormals(skin, normals);
            float most = 0;
            for (int i = 0; i < rest.Length; ++i) most = Math.Max(most, Math.Abs(posed[i] - rest[i]));
            Expect(most > 1e-4f && most < 0.1f, "the pose moves");
            Expect(Math.Abs(normals[0] * normals[0] + normals[1] * normals[1] + normals[2] * normals[2] - 1) < 1e-3, "unit normals");
            face.SetLayer(1, Fascia.Combine.Max, 0.5f);
            face.LayerValues(1)[muscle] = 1;
            face.LookAt(0, 1.6f, 1);
            face.Blend(0.5f, 0.2f);
            Expect(face.Step(1f / 60), "a step");
            byte[] state = face.Save();
            face.Step(1f / 60);
            face.WritePositions(skin, posed);
            var again = new float[3 * count];
            face.Restore(state);
            face.Step(1f / 60);
            face.WritePositions(skin, again);
            for (int i = 0; i < again.Length; ++i) Expect(again[i] == posed[i], "the same bits after a state was put back");
            using (var curves = new Fascia.Curves(Encoding.UTF8.GetBytes("time," + asset.Channels[muscle].Name + "\n0,0\n1,1\n")))
                face.Apply(curves, 0.5);
            face.Step(1f / 60);

            face.Step(1f / 60);
            long before = GC.GetTotalMemory(true);
            int collections = GC.CollectionCount(0);
            for (int i = 0; i < 200; ++i)
            {
                face.Values[muscle] = 0.01f * (i % 100);
                face.Set("jaw_open", 0.3f);
                face.Step(1f / 60);
                face.WritePositions(skin, again);
            }
            Expect(GC.CollectionCount(0) == collections && GC.GetTotalMemory(false) - before < 65536, "a frame makes no garbage");
            try
            {
                face.Set("no such thing", 1);
                Expect(false, "an unknown name is refused");
            }
            catch (Fascia.FasciaException error)
            {
                Expect(error.Message.Contains("no such thing"), "the message names it");
            }
            Console.WriteLine("csharp: " + asset.Channels.Length + " channels, all passed");
        }
        return 0;
    }
}
