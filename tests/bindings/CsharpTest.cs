// The C# binding on a rig: mono CsharpTest.exe RIG.glb [HEAD.glb STREAM.csv], see python_test.py
using System;
using System.IO;
using System.Text;

static class CsharpTest
{
    static void Expect(bool condition, string what)
    {
        if (!condition) throw new Exception("failed: " + what);
    }

    static float[] Points(string line)
    {
        string[] fields = line.Split(',');
        var points = new float[fields.Length - 1];
        for (int i = 0; i < points.Length; ++i)
            points[i] = fields[i + 1] == "" ? float.NaN : float.Parse(fields[i + 1], System.Globalization.CultureInfo.InvariantCulture);
        return points;
    }

    static unsafe void Follow(string rig, string stream)
    {
        string[] lines = File.ReadAllLines(stream);
        using (var head = Fascia.Asset.Load(File.ReadAllBytes(rig)))
        using (var face = new Fascia.Face(head))
        using (var fit = new Fascia.Fit(head))
        {
            Expect(fit.PointCount == 68 && fit.Dimensions == 3 && fit.LandmarkCount > 20, "68 points");
            fit.SetNeutral(Points(lines[1]));
            int seen = 0;
            int jaw = Array.FindIndex(head.Channels, channel => channel.Name == "jaw_open");
            float most = 0;
            for (int i = 1; i <= 20; ++i)
            {
                seen = fit.Push(Points(lines[i]));
                most = Math.Max(most, fit.Values[jaw]);
            }
            Expect(seen > 20 && fit.Residual < 5e-4f, "the face follows the points");
            Expect(fit.Scale > 900 && fit.Scale < 1100 && fit.Head[15] == 1, "the stream is in millimetres");
            Expect(most > 0.1f, "the jaw opens");
            for (int i = 0; i < head.Channels.Length; ++i) face.Values[i] = fit.Values[i];
            Expect(face.Step(1f / 60), "a step of what was found");
            try
            {
                fit.Push(new float[3]);
                Expect(false, "a short frame is refused");
            }
            catch (ArgumentException) { }
        }
    }

    /// Members' indices: every one is found by its name, and drives by either what it drives.
    static unsafe void CheckMembers(Fascia.Asset asset)
    {
        int set, member;
        Expect(asset.Sets.Length > 0 && Array.Exists(asset.Sets, entry => entry.Name == "arkit"), "the set arkit");
        for (int s = 0; s < asset.Sets.Length; ++s)
            for (int m = 0; m < asset.Sets[s].Members.Length; ++m)
            {
                asset.FindMember(asset.Sets[s].Name + ":" + asset.Sets[s].Members[m], out set, out member);
                Expect(set == s && member == m, asset.Sets[s].Members[m] + " is found");
            }
        try
        {
            asset.FindMember("nobody's:jawOpen", out set, out member);
            Expect(false, "an unknown member is refused");
        }
        catch (Fascia.FasciaException) { }
        asset.FindMember("arkit:jawOpen", out set, out member);
        int jaw = Array.FindIndex(asset.Channels, channel => channel.Name == "jaw_open");
        using (var face = new Fascia.Face(asset))
        {
            face.Set("arkit:jawOpen", 0.5f);
            face.Step(1f / 60);
            float byName = face.EffectiveValues[jaw];
            Expect(byName > 0, "the jaw opens by name");
            face.Clear();
            face.SetMember(set, member, 0.5f);
            face.Step(1f / 60);
            Expect(face.EffectiveValues[jaw] == byName, "the jaw opens by index");
            face.Clear();
            face.SetLayer(1, Fascia.Combine.Add);
            face.LayerSetMember(1, set, member, 0.5f);
            face.Step(1f / 60);
            Expect(face.EffectiveValues[jaw] == byName, "the jaw opens by a layer");
            face.LayerClear(1);
            face.LayerSet(1, "jaw_open", 0.25f);
            face.Step(1f / 60);
            Expect(face.EffectiveValues[jaw] == 0.25f && face.LayerValues(1)[jaw] == 0.25f, "a layer's channel by name");
            face.LayerRemove(1);
            face.Step(1f / 60);
            Expect(face.EffectiveValues[jaw] == 0 && face.LayerValues(1) == null, "the layer is removed");
            try
            {
                face.SetMember(set, 999, 1);
                Expect(false, "a member that is not there is refused");
            }
            catch (Fascia.FasciaException) { }
        }
    }

    static unsafe int Main(string[] arguments)
    {
        if (arguments.Length > 2) Follow(arguments[1], arguments[2]);
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
            CheckMembers(asset);
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
